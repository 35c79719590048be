// throng bench frame: whole updates, staged and fused, beside what memory alone costs.
#include "bench/frame_bench.h"
#include "bench/report/gnuplot.h"
#include "bench/scan_report.h"
#include "tools/cli/command.h"
#include "tools/creatures/creature.h"
#include "tools/cli/inputs.h"
#include "tools/bench/bench_commands.h"
#include "tools/scene/scatter.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdio>
#include <set>

namespace throng::tools {
namespace {

struct FrameOptions {
    std::vector<std::string> files;
    std::optional<uint32_t> count;
    uint32_t samples = 15;
    uint64_t seed = 1;
    CompileSettings compile;
    std::string device, report;
    bool quick = false, json = false;

    // Characters of a configuration that has so many.
    uint32_t characters(uint32_t usual) const { return count.value_or(quick ? usual / 10 : usual); }
};

struct Generated {
    uint32_t characters, joints, levels;
    bool compares_exact = false;
};
constexpr std::array kGenerated{Generated{10'000, 300, 15},  Generated{10'000, 300, 60, true},
                                Generated{10'000, 300, 120}, Generated{10'000, 64, 15},
                                Generated{100'000, 64, 15},  Generated{1'000, 1'000, 60}};
constexpr uint32_t kCharactersOfFile = 10'000;

double real(const nlohmann::json& record, const char* field) {
    return record.contains(field) && record[field].is_number() ? record[field].get<double>() : 0;
}
std::string word(const nlohmann::json& record, const char* field) { return record.value(field, std::string()); }

void print_table(std::span<const nlohmann::json> records) {
    const nlohmann::json& first = records.front();
    std::printf("\n%s: %u characters x %u joints, %u levels (mean depth %.1f), keys %s\n",
                word(first, "configuration").c_str(), first["characters"].get<uint32_t>(),
                first["joints"].get<uint32_t>(), first["levels"].get<uint32_t>(), real(first, "mean_depth"),
                word(first, "keys").c_str());
    std::printf("%-18s %9s %19s %9s %9s %8s %7s  %s\n", "variant", "ms", "5 % - 95 %", "ns/joint", "MB", "GB/s",
                "x fill", "error");
    for (const nlohmann::json& record : records) {
        std::printf("%-18s ", word(record, "variant").c_str());
        if (record.contains("unsupported_reason")) {
            std::printf("not measured: %s\n", word(record, "unsupported_reason").c_str());
            continue;
        }
        if (record.contains("wrong")) {
            std::printf("WRONG, not timed: it is %s of the size off\n", record["max_error"].dump().c_str());
            continue;
        }
        const nlohmann::json& ms = record["ms"];
        std::printf("%9.3f %9.3f -%8.3f %9.3f ", real(ms, "median"), real(ms, "p5"), real(ms, "p95"),
                    real(record, "ns_per_joint"));
        std::printf("%9.1f %8.1f ", real(record, "bytes") * 1e-6, real(record, "gb_per_s"));
        if (record.contains("max_error"))
            std::printf("%7.2f  %.1e", real(record, "times_fill_floor"), real(record, "max_error"));
        else
            std::printf("%7s  by %s", "", word(record, "by").c_str());
        if (const double by_host = real(record, "host_samples"); by_host > 0)
            std::printf(", %g of %g rounds by the host's clock", by_host, real(record, "samples"));
        std::printf("\n");
    }
    std::fflush(stdout);
}

class FrameRun {
public:
    explicit FrameRun(const FrameOptions& options) : options_(options), device_(open_device(options.device)) {}

    // A run with other keys is another configuration, also where the records of both end in one report.
    void measure(std::string configuration, const Character& character, const Character* exact, uint32_t count) {
        const std::string keys = keys_text(character);
        if (options_.compile.error != CompileSettings().error) configuration += ", keys " + keys;
        const Scatter field = scatter({&character, 1}, {.counts = {count}, .seed = options_.seed});
        const bench::FrameCase frame{.configuration = configuration,
                                     .character = &character,
                                     .keys = keys,
                                     .exact = exact,
                                     .playback = field.playback};
        const std::vector<nlohmann::json> records = bench::measure_frame(device_, frame, options_.samples,
                                                                         print_progress);
        print_progress("");
        if (!options_.json) {
            if (all_.empty())
                std::printf("%s, driver %s; medians of %u rounds\n", device_.info().name.c_str(),
                            device_.info().driver.c_str(), options_.samples);
            print_table(records);
        }
        for (const nlohmann::json& record : records) {
            if (options_.json) print_json(record);
            all_.push_back(record);
        }
        std::fflush(stdout);
    }

    void measure_generated(const Generated& generated) {
        const uint32_t count = options_.characters(generated.characters);
        const std::string configuration = std::to_string(count) + " x " + std::to_string(generated.joints) + ", " +
                                          std::to_string(generated.levels) + " levels";
        if (!generated_.insert(configuration).second) return;  // --count makes some of them the same
        print_progress(configuration + ": compiling");
        const Asset asset = unwrap(
            make_creature({.joint_count = generated.joints, .level_count = generated.levels, .seed = options_.seed}));
        const Character character = unwrap(compile_character(asset, options_.compile));
        std::optional<Character> exact;
        if (generated.compares_exact && character.packed) exact = unwrap(compile_character(asset, kExact));
        measure(configuration, character, exact ? &*exact : nullptr, count);
    }

    void measure_file(const std::string& file) {
        print_progress("reading " + file);
        const Character character = unwrap(load_character(file, options_.compile));
        print_warnings(character.warnings);
        const uint32_t count = options_.characters(kCharactersOfFile);
        measure(std::to_string(count) + " x " + std::filesystem::path(file).filename().string(), character, nullptr,
                count);
    }

    const std::vector<nlohmann::json>& records() const { return all_; }

private:
    const FrameOptions& options_;
    Device device_;
    std::set<std::string> generated_;
    std::vector<nlohmann::json> all_;
};

void run_frame(const FrameOptions& options) {
    keep_inputs(options.files, {options.report});
    // Where it is missing, that is said before the minutes of work
    if (!options.report.empty()) bench::run_gnuplot("");
    FrameRun run(options);
    for (const std::string& file : options.files) run.measure_file(file);
    if (options.files.empty())
        for (const Generated& generated : kGenerated) run.measure_generated(generated);
    if (!options.report.empty()) {
        const std::string page = bench::scan_report(run.records());
        write_file(options.report, std::as_bytes(std::span(page)));
    }
    const auto is_wrong = [](const nlohmann::json& record) { return record.contains("wrong"); };
    if (std::any_of(run.records().begin(), run.records().end(), is_wrong)) throw CommandError("an update is wrong");
}

}  // namespace

void add_bench_frame(Command bench) {
    Command command = bench.add_subcommand("frame",
                                           "whole updates, staged and fused, in each output format: checked, then "
                                           "timed beside a fill and a copy of the same bytes");
    auto options = std::make_shared<FrameOptions>();
    command.add_option("files", options->files,
                       "glTF 2.0 files (default: generated creatures of 64 to 1,000 joints, up to 100,000 of them)");
    command.add_option("--count", options->count, "characters in each configuration (default: its own)")
        .check(range(1u, 10'000'000u));
    Option samples = command.add_option("--samples", options->samples, "rounds timed")
                         .check(range(1u, 100'000u))
                         .capture_default_str();
    add_error_option(command, options->compile);
    command.add_option("--seed", options->seed, "of creatures, clips, times and blends").capture_default_str();
    command.add_flag("--quick", options->quick, "a tenth of the characters, and 3 rounds");
    command.add_flag("--json", options->json, "a JSON record a line; its commit is taken from THRONG_COMMIT");
    command.add_option("--report", options->report, "a file for the report, one HTML page").check(writable_file());
    add_device_option(command, options->device);
    command.footer(
        "Examples:\n  throng bench frame\n  throng bench frame --quick --report frame.html\n"
        "  throng bench frame fox.glb --count 5000 --error exact\n  throng bench frame --json > frame.jsonl");
    command.callback([options, samples] {
        if (options->quick && samples.empty()) options->samples = 3;
        run_frame(*options);
    });
}

}  // namespace throng::tools
