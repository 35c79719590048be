// throng bench frame: whole updates, staged and fused, beside what memory alone costs.
#include "bench/frame_bench.h"
#include "tools/cli/command.h"
#include "tools/creatures/creature.h"
#include "tools/cli/inputs.h"
#include "tools/bench/bench_commands.h"
#include "tools/bench/measured.h"
#include "tools/scene/scatter.h"

#include <array>
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

    // The number of characters of a configuration that usually has `usual`.
    uint32_t characters(uint32_t usual) const { return count.value_or(quick ? usual / 10 : usual); }
};

struct GeneratedFrame {
    uint32_t characters, joints, levels;
    bool compares_exact = false;
};
constexpr std::array kGeneratedFrames{GeneratedFrame{10'000, 300, 15},  GeneratedFrame{10'000, 300, 60, true},
                                      GeneratedFrame{10'000, 300, 120}, GeneratedFrame{10'000, 64, 15},
                                      GeneratedFrame{100'000, 64, 15},  GeneratedFrame{1'000, 1'000, 60}};
constexpr uint32_t kCharactersOfFile = 10'000;

void print_frame_table(std::span<const Json> records) {
    const Json& first = records.front();
    std::printf("\n%s: ", text(first, "configuration").c_str());
    print_columns(first, {{"%.0f characters", "characters"},
                          {" x %.0f joints", "joints"},
                          {", %.0f levels", "levels"},
                          {" (mean depth %.1f)", "mean_depth"}});
    std::printf(", keys %s\n%-18s %9s %19s %9s %9s %8s %7s  %s\n", text(first, "keys").c_str(), "variant", "ms",
                "5 % - 95 %", "ns/joint", "MB", "GB/s", "x fill", "error");
    for (const Json& record : records) {
        std::printf("%-18s ", text(record, "variant").c_str());
        if (print_untimed(record, "not measured")) continue;
        print_columns(record, {{"%9.3f", "ms/median"},
                               {" %9.3f", "ms/p5"},
                               {" -%8.3f", "ms/p95"},
                               {" %9.3f", "ns_per_joint"},
                               {" %9.1f", "bytes", 1e-6},
                               {" %8.1f ", "gb_per_s"}});
        if (record.contains("max_error"))
            print_columns(record, {{"%7.2f", "times_fill_floor"}, {"  %.1e", "max_error"}});
        else
            std::printf("%7s  by %s", "", text(record, "by").c_str());
        if (real(record, "host_samples") > 0)
            print_columns(record, {{", %g of", "host_samples"}, {" %g rounds by the host's clock", "samples"}});
        std::printf("\n");
    }
}

class FrameRun {
public:
    explicit FrameRun(const FrameOptions& options)
        : options_(options), device_(open_vulkan_device(options.device)), measured_(options.json) {}

    // A run with other keys counts as another configuration, so that one report can hold the records of both.
    void measure(std::string configuration, const Character& character, const Character* exact, uint32_t count) {
        const std::string keys = keys_text(character);
        if (options_.compile.error != CompileSettings().error) configuration += ", keys " + keys;
        const Scatter field = scatter({&character, 1}, {.counts = {count}, .seed = options_.seed});
        const bench::FrameCase frame{.configuration = configuration,
                                     .character = &character,
                                     .keys = keys,
                                     .exact = exact,
                                     .playback = field.playback};
        const std::vector<Json> records = bench::measure_frame(device_, frame, options_.samples, print_progress);
        measured_.add(records, [&] {
            if (measured_.all().empty())
                std::printf("%s, driver %s; medians of %u rounds\n", device_.info().name.c_str(),
                            device_.info().driver.c_str(), options_.samples);
            print_frame_table(records);
        });
    }

    void measure_generated(const GeneratedFrame& generated) {
        const uint32_t count = options_.characters(generated.characters);
        const std::string configuration = std::to_string(count) + " x " + std::to_string(generated.joints) + ", " +
                                          std::to_string(generated.levels) + " levels";
        if (!generated_.insert(configuration).second) return;  // with --count some are the same
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

    const Measured& measured() const { return measured_; }

private:
    const FrameOptions& options_;
    Device device_;
    std::set<std::string> generated_;
    Measured measured_;
};

void run_frame(const FrameOptions& options) {
    protect_inputs(options.files, {options.report});
    check_report(options.report);
    FrameRun run(options);
    for (const std::string& file : options.files) run.measure_file(file);
    if (options.files.empty())
        for (const GeneratedFrame& generated : kGeneratedFrames) run.measure_generated(generated);
    run.measured().finish(options.report, "an update");
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
    Option samples = add_samples_option(command, options->samples, "rounds timed");
    add_error_option(command, options->compile);
    command.add_option("--seed", options->seed, "seed of creatures, clips, times and blends").capture_default_str();
    command.add_flag("--quick", options->quick, "a tenth of the characters, and 3 rounds");
    add_json_flag(command, options->json);
    add_report_option(command, options->report);
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
