// throng bench scan: every method of the Hierarchy-Scan, checked and timed side by side.
#include "bench/scan_bench.h"
#include "tools/cli/command.h"
#include "tools/bench/bench_commands.h"
#include "tools/bench/measured.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace throng::tools {
namespace {

struct ScanOptions {
    bench::ScanBenchSettings settings;
    std::vector<std::string> methods{"all"};
    std::string shape = "random", device, json, report;
};

void print_cell(std::span<const Json> records) {
    const Json& first = records.front();
    const bool on_chip = text(first, "experiment") == "on_chip";
    std::printf("\n%s:", on_chip ? "on-chip, without memory" : "from memory to memory");
    print_columns(first, {{" %.0f characters", "characters"}, {" x %.0f joints", "joints"}});
    std::printf(", %s", text(first, "shape").c_str());
    print_columns(first,
                  {{", %.0f levels", "levels"}, {" (mean depth %.1f)", "mean_depth"}, {", %.0f leaves", "leaves"}});
    std::printf("\n%-22s %5s %9s %19s %8s %15s %7s %8s %9s\n", "method", "threads", on_chip ? "ns/joint" : "ms",
                "5 % - 95 %", on_chip ? "barriers" : "x copy", "multiplications", "longest", "barriers", "error");
    for (const Json& record : records) {
        const std::string chosen = text(record, "chosen");
        std::printf("%-22s ", chosen.empty() ? text(record, "method").c_str() : ("auto: " + chosen).c_str());
        if (print_untimed(record, "does not apply", " off")) continue;
        const double threads = real(record, "threads");
        std::printf("%5s", threads > 0 ? std::to_string(std::lround(threads)).c_str() : "");
        if (on_chip)
            print_columns(record, {{" %9.3f", "on_chip_ns_per_joint"},
                                   {" %9.3f", "on_chip_p5"},
                                   {" -%8.3f", "on_chip_p95"},
                                   {" %6.0f %%", "barrier_share", 100}});
        else
            print_columns(
                record,
                {{" %9.3f", "median_ms"}, {" %9.3f", "p5_ms"}, {" -%8.3f", "p95_ms"}, {" %8.2f", "times_copy"}});
        print_columns(record, {{" %15.0f", "multiplications"},
                               {" %7.0f", "longest_thread"},
                               {" %8.0f", "barriers"},
                               {"   %.1e\n", "max_error"}});
    }
    const auto copied = std::ranges::find_if(records, [](const Json& record) { return record.contains("copy_ms"); });
    if (!on_chip && copied != records.end()) {
        std::printf("%-28s", "copy");
        print_columns(*copied, {{" %9.3f\n", "copy_ms"}});
    }
}

void run_scan(const ScanOptions& options) {
    check_report(options.report);
    const Device device = open_vulkan_device(options.device);
    Measured measured;
    bench::run_scan_bench(device, options.settings, print_progress, [&](std::span<const Json> records) {
        measured.add(records, [&] {
            if (measured.all().empty())
                std::printf("%s, driver %s, subgroups of %u\n", device.info().name.c_str(),
                            device.info().driver.c_str(), device.info().subgroup_size);
            print_cell(records);
        });
        // After each cell, so that a long run that is stopped keeps its results
        if (!options.json.empty()) write_text(options.json, measured.lines());
    });
    measured.finish(options.report, "a scan method");
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

    command.add_option("--methods", options->methods, "all, or names, optionally with their invocations per character")
        .delimiter(',')
        .check(scan_name({"all"}))
        .capture_default_str();
    const std::vector<Option> of_levels{
        command.add_option("--characters", settings.characters, "characters in the experiment 'levels'")
            .check(range(1u, 10'000'000u))
            .capture_default_str(),
        command.add_option("--joints", settings.joints, "joints of each of these characters")
            .check(range(1u, 65'535u))
            .capture_default_str(),
        command.add_option("--levels", settings.levels, "levels of random skeletons; those of other shapes follow")
            .delimiter(',')
            .check(range(1u, 65'535u))
            .capture_default_str(),
        command.add_option("--shape", options->shape, "shape of the skeleton")
            .check(is_member(shapes))
            .capture_default_str()};
    command.add_option("--seed", settings.seed, "seed of skeletons and poses").capture_default_str();
    Option samples = add_samples_option(command, settings.sampling.samples,
                                        "samples of each method in each case, if the time suffices");
    Option chosen = command
                        .add_option("--experiments", settings.experiments,
                                    "levels: the paper's; joints: 16 to 4096; characters: 1 to 100,000; on_chip: "
                                    "without memory; grid: 39 cases for the planner")
                        .delimiter(',')
                        .check(is_member(experiments))
                        .capture_default_str();
    Option budget = command
                        .add_option("--budget", settings.sampling.budget_s,
                                    "seconds for the whole run; slow cases get fewer samples, but at least 3")
                        .check(range(1.0, 1e6))
                        .capture_default_str();
    command.add_flag("--quick", settings.quick, "less of everything: under a minute");
    add_json_file_option(command, options->json);
    add_report_option(command, options->report);
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
            s.sampling.min_samples = 1;
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
