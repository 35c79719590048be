// throng bench cpu: whole updates on the processor, beside what memory alone costs.
#include "bench/cpu_bench.h"
#include "tools/bench/bench_commands.h"
#include "tools/bench/measured.h"
#include "tools/cli/command.h"
#include "tools/cli/inputs.h"
#include "tools/creatures/creature.h"

#include <cstdio>
#include <filesystem>
#include <optional>

namespace throng::tools {
namespace {

struct CpuOptions {
    std::vector<std::string> files;
    std::optional<uint32_t> characters, joints, levels;
    std::string isa = "all", clips = "all";
    std::vector<uint32_t> threads;
    uint32_t samples = 15;
    uint64_t seed = 1;
    bool json = false;
};

struct GeneratedCrowd {
    uint32_t characters = 10'000, joints = 300, levels = 60;
};
constexpr std::array kGeneratedCrowds{GeneratedCrowd{},
                                      GeneratedCrowd{.levels = 15},
                                      GeneratedCrowd{.levels = 120},
                                      GeneratedCrowd{.joints = 64, .levels = 15},
                                      GeneratedCrowd{100'000, 64, 15},
                                      GeneratedCrowd{1'000, 1'000, 60}};

void print_cpu_row(const Json& record) {
    std::printf("%-8s %7.0f  %-20s ", text(record, "isa").c_str(), real(record, "threads"),
                text(record, "variant").c_str());
    if (print_untimed(record, "not measured")) return;
    print_columns(record, {{"%9.3f", "ms/median"},
                           {" %9.3f", "ms/p5"},
                           {" -%8.3f", "ms/p95"},
                           {" %9.2f", "ns_per_joint"},
                           {" %8.1f", "gb_per_s"},
                           {" %9.3f", "wall_ms/p5"}});
    if (record.contains("times_one_thread"))
        print_columns(record, {{" %6.2f", "times_one_thread"}});
    else
        std::printf("%7s", "");
    if (record.contains("times_fill_floor"))
        print_columns(record,
                      {{" %7.2f", "times_fill_floor"}, {" %7.0f %%", "decode_share", 100}, {"  %.1e", "max_error"}});
    std::printf("\n");
}

void print_cpu_table(std::span<const Json> records) {
    const Json& first = records.front();
    std::printf(
        "\n%s on %s; %.0f updates, 48-byte matrices; processor time, and on the wall; rates at the 5th percentile\n"
        "%-8s %7s  %-20s %9s %19s %9s %8s %9s %6s %7s %9s  %s\n",
        text(first, "configuration").c_str(), text(first, "device").c_str(), real(first, "samples"), "isa", "threads",
        "variant", "ms", "5 % - 95 %", "ns/joint", "GB/s", "wall ms", "x one", "x fill", "decode", "error");
    for (const Json& record : records) print_cpu_row(record);
}

bench::CpuCase make_case(const CpuOptions& options, std::string configuration, uint32_t characters,
                         const Character& character) {
    bench::CpuCase of{.configuration = std::move(configuration),
                      .characters = characters,
                      .variants = {},
                      .isas = chosen_isas(options.isa),
                      .threads = options.threads,
                      .samples = options.samples,
                      .seed = options.seed};
    if (options.clips != "1") of.variants.push_back({"two clips", &character, 2});
    if (options.clips != "2") of.variants.push_back({"one clip", &character, 1});
    return of;
}

void run_generated(const CpuOptions& options, const GeneratedCrowd& generated, bool all_variants, Measured& measured) {
    const std::string configuration = std::to_string(generated.characters) + " x " + std::to_string(generated.joints) +
                                      ", " + std::to_string(generated.levels) + " levels";
    print_progress(configuration + ": compiling");
    const Asset asset = unwrap(
        make_creature({.joint_count = generated.joints, .level_count = generated.levels, .seed = options.seed}));
    const Character character = unwrap(compile_character(asset, {.lods = false}));
    bench::CpuCase of = make_case(options, configuration, generated.characters, character);
    if (all_variants && options.clips == "all")
        of.variants.push_back({.name = "three layers", .character = &character, .layers = true});
    std::optional<Character> moving;
    if (all_variants && options.clips != "1") {
        moving = unwrap(compile_character(bench::with_moving_translations(asset), {.lods = false}));
        of.variants.push_back({"two, all joints move", &*moving, 2});
    }
    const std::vector<Json> records = bench::measure_cpu(of, print_progress);
    measured.add(records, [&] { print_cpu_table(records); });
}

void run_file(const CpuOptions& options, const std::string& file, Measured& measured) {
    print_progress("reading " + file);
    const Character character = unwrap(load_character(file, {.lods = false}));
    if (character.clips.empty() || character.palette.empty()) throw CommandError(file + ": has no clips or no skin");
    const uint32_t characters = options.characters.value_or(GeneratedCrowd{}.characters);
    const bench::CpuCase of = make_case(
        options, std::to_string(characters) + " x " + std::filesystem::path(file).filename().string(), characters,
        character);
    const std::vector<Json> records = bench::measure_cpu(of, print_progress);
    measured.add(records, [&] { print_cpu_table(records); });
}

void run_cpu(CpuOptions options) {
    chosen_isas(options.isa);
    options.threads = or_all_and_one(options.threads);
    Measured measured(options.json);
    if (!options.files.empty()) {
        for (const std::string& file : options.files) run_file(options, file, measured);
    } else if (options.characters || options.joints || options.levels) {
        GeneratedCrowd one;
        one.characters = options.characters.value_or(one.characters);
        one.joints = options.joints.value_or(one.joints);
        one.levels = options.levels.value_or(std::min(one.levels, one.joints));
        run_generated(options, one, true, measured);
    } else {
        for (const GeneratedCrowd& generated : kGeneratedCrowds)
            run_generated(options, generated, &generated == &kGeneratedCrowds.front(), measured);
    }
    measured.finish("", "an update");
}

}  // namespace

void add_bench_cpu(Command bench) {
    Command command = bench.add_subcommand("cpu",
                                           "whole updates on the processor, with each of its instruction sets: "
                                           "checked, then timed beside a fill of the same bytes; needs no device");
    auto options = std::make_shared<CpuOptions>();
    Option files = command.add_option("files", options->files, "glTF 2.0 files (default: generated creatures)");
    command.add_option("--characters", options->characters, "number of characters (default: several cases)")
        .check(range(1u, 10'000'000u));
    command.add_option("--joints", options->joints, "joints of each generated creature")
        .excludes(files)
        .check(range(2u, 65'535u));
    command.add_option("--levels", options->levels, "levels of its skeleton").excludes(files).check(range(2u, 65'535u));
    command.add_option("--clips", options->clips, "clips that each character plays")
        .check(is_member({"1", "2", "all"}))
        .capture_default_str();
    add_threads_option(command, options->threads);
    add_isa_option(command, options->isa);
    add_samples_option(command, options->samples);
    command.add_option("--seed", options->seed, "seed of creatures, clips, times and blends").capture_default_str();
    add_json_flag(command, options->json);
    command.footer(
        "Examples:\n  throng bench cpu\n  throng bench cpu fox.glb --characters 20000\n  throng bench cpu --characters "
        "1000 --joints 64 --levels 15 --threads 1,2\n"
        "  throng bench cpu --isa avx2 --json > cpu.jsonl");
    command.callback([options] { run_cpu(*options); });
}

}  // namespace throng::tools
