// throng bench scan: every method of the Hierarchy-Scan, checked and timed side by side.
#include "bench/report/gnuplot.h"
#include "bench/scan_bench.h"
#include "bench/scan_report.h"
#include "tools/cli/command.h"
#include "tools/bench/bench_commands.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdio>

namespace throng::tools {
namespace {

struct ScanOptions {
    bench::ScanBenchSettings settings;
    std::vector<std::string> methods{"all"};
    std::string shape = "random", device, json, report;
};

double real(const nlohmann::json& record, const char* field) {
    return record.at(field).is_number() ? record.at(field).get<double>() : 0;
}
uint64_t count(const nlohmann::json& record, const char* field) { return record.at(field).get<uint64_t>(); }

void print_cell(std::span<const nlohmann::json> records) {
    const nlohmann::json& first = records.front();
    const bool on_chip = first.at("experiment") == "on_chip";
    std::printf("\n%s: %zu characters x %zu joints, %s, %zu levels (mean depth %.1f), %zu leaves\n",
                on_chip ? "on-chip, without memory" : "from memory to memory", count(first, "characters"),
                count(first, "joints"), first.at("shape").get<std::string>().c_str(), count(first, "levels"),
                real(first, "mean_depth"), count(first, "leaves"));
    std::printf("%-22s %5s %9s %19s %8s %15s %7s %8s %9s\n", "method", "threads", on_chip ? "ns/joint" : "ms",
                "5 % - 95 %", on_chip ? "barriers" : "x copy", "multiplications", "longest", "barriers", "error");
    for (const nlohmann::json& record : records) {
        const std::string chosen = record.value("chosen", std::string());
        std::printf("%-22s ",
                    chosen.empty() ? record.at("method").get<std::string>().c_str() : ("auto: " + chosen).c_str());
        if (record.contains("unsupported_reason")) {
            std::printf("does not apply: %s\n", record.at("unsupported_reason").get<std::string>().c_str());
            continue;
        }
        if (record.contains("wrong")) {
            std::printf("WRONG, not timed: it is %s off\n", record.at("max_error").dump().c_str());
            continue;
        }
        const uint64_t lanes = count(record, "threads");
        std::printf("%5s %9.3f %9.3f -%8.3f ", lanes ? std::to_string(lanes).c_str() : "",
                    real(record, on_chip ? "on_chip_ns_per_joint" : "median_ms"),
                    real(record, on_chip ? "on_chip_p5" : "p5_ms"), real(record, on_chip ? "on_chip_p95" : "p95_ms"));
        if (on_chip)
            std::printf("%6.0f %%", 100 * real(record, "barrier_share"));
        else
            std::printf("%8.2f", real(record, "times_copy"));
        std::printf(" %15zu %7zu %8zu   %.1e\n", count(record, "multiplications"), count(record, "longest_thread"),
                    count(record, "barriers"), real(record, "max_error"));
    }
    if (!on_chip)
        for (const nlohmann::json& record : records)
            if (record.contains("copy_ms")) {
                std::printf("%-22s %5s %9.3f\n", "copy", "", real(record, "copy_ms"));
                break;
            }
    std::fflush(stdout);
}

void write_text(const std::string& path, const std::string& text) { write_file(path, std::as_bytes(std::span(text))); }

void run_scan(const ScanOptions& options) {
    // Where it is missing, that is said before the minutes of work
    if (!options.report.empty()) bench::run_gnuplot("");
    const Device device = open_device(options.device);
    std::vector<nlohmann::json> all;
    std::string lines;
    bench::run_scan_bench(device, options.settings, print_progress, [&](std::span<const nlohmann::json> records) {
        print_progress("");
        if (all.empty())
            std::printf("%s, driver %s, subgroups of %u\n", device.info().name.c_str(), device.info().driver.c_str(),
                        device.info().subgroup_size);
        print_cell(records);
        for (const nlohmann::json& record : records)
            lines += record.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
        all.insert(all.end(), records.begin(), records.end());
        // Cell after cell: a long run that is stopped leaves what it has
        if (!options.json.empty()) write_text(options.json, lines);
    });
    if (!options.report.empty()) write_text(options.report, bench::scan_report(all));
    if (std::any_of(all.begin(), all.end(), [](const nlohmann::json& record) { return record.contains("wrong"); }))
        throw CommandError("a scan method is wrong");
}

}  // namespace

void add_bench_scan(Command bench_command) {
    Command command = bench_command.add_subcommand(
        "scan", "the methods of the Hierarchy-Scan: each checked, then timed beside a copy of the same bytes");
    auto options = std::make_shared<ScanOptions>();
    bench::ScanBenchSettings& settings = options->settings;
    std::vector<std::string> shapes, experiments = bench::scan_experiments();
    for (const bench::SkeletonShape shape : bench::kSkeletonShapes) shapes.emplace_back(name_of(shape));
    experiments.push_back("all");

    command.add_option("--methods", options->methods, "all, or names with their invocations a character or without")
        .delimiter(',')
        .check(scan_name({"all"}))
        .capture_default_str();
    const std::vector<Option> of_levels{
        command.add_option("--characters", settings.characters, "of the experiment 'levels'")
            .check(range(1u, 10'000'000u))
            .capture_default_str(),
        command.add_option("--joints", settings.joints, "of each character there")
            .check(range(1u, 65'535u))
            .capture_default_str(),
        command.add_option("--levels", settings.levels, "of random skeletons; the others' follow from the joints")
            .delimiter(',')
            .check(range(1u, 65'535u))
            .capture_default_str(),
        command.add_option("--shape", options->shape, "of the skeleton")
            .check(is_member(shapes))
            .capture_default_str()};
    command.add_option("--seed", settings.seed, "of skeletons and poses").capture_default_str();
    Option samples = command
                         .add_option("--samples", settings.sampling.samples,
                                     "of each method in each case, where the time suffices")
                         .check(range(1u, 100'000u))
                         .capture_default_str();
    Option chosen = command
                        .add_option("--experiments", settings.experiments,
                                    "levels: the paper's; joints: 16 to 4096; characters: 1 to 100,000; on_chip: "
                                    "without memory; grid: 42 cases for the planner")
                        .delimiter(',')
                        .check(is_member(experiments))
                        .capture_default_str();
    Option budget = command
                        .add_option("--budget", settings.sampling.budget_s,
                                    "seconds; what is slow gets fewer samples then, but 3 at least")
                        .check(range(1.0, 1e6))
                        .capture_default_str();
    command.add_flag("--quick", settings.quick, "less of everything: under a minute");
    command
        .add_option("--json", options->json,
                    "a file for the records, one a line; their commit is taken from THRONG_COMMIT")
        .check(writable_file());
    command.add_option("--report", options->report, "a file for the report, one HTML page").check(writable_file());
    add_device_option(command, options->device);
    command.footer(
        "Without options: the paper's experiment, and how the methods scale with joints and characters.\nExamples:\n"
        "  throng bench scan\n  throng bench scan --quick --json scan.jsonl --report scan.html\n"
        "  throng bench scan --methods serial,compressed,subgroup:8 --characters 1000 --joints 64 --levels 10,20\n"
        "  throng bench scan --shape chain --joints 100 --experiments levels");
    command.callback([=] {
        bench::ScanBenchSettings& s = options->settings;
        if (s.quick) {
            if (of_levels[0].empty()) s.characters = 1'000;
            if (of_levels[2].empty()) s.levels = {15, 60, 120};
            if (samples.empty()) s.sampling.samples = 3;
            if (budget.empty()) s.sampling.budget_s = 20;
            s.sampling.least_samples = 1;
        }
        const bool asks_for_levels = std::any_of(of_levels.begin(), of_levels.end(),
                                                 [](Option option) { return !option.empty(); });
        if (chosen.empty() && asks_for_levels) s.experiments = {"levels", "on_chip"};
        if (std::find(s.experiments.begin(), s.experiments.end(), "all") != s.experiments.end())
            s.experiments = bench::default_scan_experiments();
        s.shape = *std::find_if(bench::kSkeletonShapes.begin(), bench::kSkeletonShapes.end(),
                                [&](bench::SkeletonShape shape) { return name_of(shape) == options->shape; });
        if (std::find(options->methods.begin(), options->methods.end(), "all") == options->methods.end())
            s.methods = options->methods;
        run_scan(*options);
    });
}

}  // namespace throng::tools
