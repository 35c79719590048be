// throng bench baselines: what baking saves, and what it costs.
#include "base/failure.h"
#include "bench/baselines/baselines.h"
#include "bench/record.h"
#include "bench/skin_error.h"
#include "tools/cli/statistics.h"
#include "tools/cli/command.h"
#include "tools/creatures/creature.h"
#include "tools/creatures/creature_math.h"
#include "tools/cli/inputs.h"
#include "tools/bench/bench_commands.h"
#include "tools/scene/scatter.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdio>
#include <numeric>

namespace throng::tools {
namespace {

struct BaselineOptions {
    std::vector<std::string> files;
    std::vector<uint32_t> levels{15, 60, 120};
    uint32_t joints = 300, count = 10'000, samples = 15;
    double rate = 30;
    uint64_t seed = 1;
    std::string device, json;
};

// Instances of a character under one method.
struct Running {
    std::function<double(float time_step_s)> update_ms;
    std::function<std::vector<Affine>(uint32_t instance)> skin_matrices;
    std::function<StageTimes()> stage_times;  // none where the method has no stages
};

// throng's update, or a baseline's.
struct Method {
    std::string name;
    const Character* stored = nullptr;  // the clips as the method stores them
    std::function<std::vector<AffineT<double>>(const Playback&)> definition;
    std::function<Running(std::span<const Playback>)> start;
};

std::vector<AffineT<double>> reference_matrices(const Character& character, const Playback& playback) {
    return unwrap(reference_pose(character, playback)).model_from_bind;
}

Method throng_itself(const Device& device, const Character& character) {
    const auto start = [&](std::span<const Playback> playbacks) {
        const auto crowd = std::make_shared<Crowd>(
            unwrap(Crowd::create(device, {.groups = {{&character, static_cast<uint32_t>(playbacks.size())}}})));
        unwrap(crowd->set_playback(0, playbacks));
        const auto update_ms = [crowd](float time_step_s) {
            unwrap(crowd->update(time_step_s));
            return unwrap(crowd->stage_times()).total();
        };
        return Running{update_ms, [crowd](uint32_t instance) { return unwrap(crowd->read_skin_matrices(instance)); },
                       [crowd] { return unwrap(crowd->stage_times()); }};
    };
    return {"throng", &character, [&](const Playback& playback) { return reference_matrices(character, playback); },
            start};
}

Method baseline_method(const Device& device, const bench::Baseline& baseline, const Character& baked) {
    const auto start = [&](std::span<const Playback> playbacks) {
        const auto crowd = std::make_shared<bench::BaselineCrowd>(device.gpu(), baseline, baked, playbacks);
        return Running{[crowd](float time_step_s) { return crowd->update_ms(time_step_s); },
                       [crowd](uint32_t instance) { return crowd->read_skin_matrices(instance); },
                       {}};
    };
    return {std::string(baseline.name), &baked,
            [&](const Playback& playback) { return baseline.skin_matrices(baked, playback); }, start};
}

// Of some instances, from the method's own definition.
double largest_error(const Method& method, const Running& running, std::span<const Playback> playbacks) {
    constexpr size_t kChecked = 16;
    double worst = 0;
    for (size_t i = 0; i < std::min(kChecked, playbacks.size()); ++i) {
        const auto instance = static_cast<uint32_t>(playbacks.size() * i / std::min(kChecked, playbacks.size()));
        worst = std::max(worst, bench::skin_error(running.skin_matrices(instance),
                                                  method.definition(playbacks[instance]), method.stored->size));
    }
    return worst;
}

// One clip at any time; or, with each of the weights, two clips: different ones where the character has several.
std::vector<Playback> playbacks_to_compare(const Character& character, bool blended, uint64_t seed) {
    constexpr uint32_t kMoments = 32;
    constexpr std::array kOne{1.0f};
    constexpr std::array kWeights{0.25f, 0.5f, 0.75f};
    creature::Random random(seed);
    const auto clip_count = static_cast<uint32_t>(character.clips.size());
    const auto at_any_time = [&](uint32_t clip) {
        return ClipPlayback{.clip = clip, .time_s = random.unit() * character.clips[clip].duration_s};
    };
    std::vector<Playback> out;
    for (uint32_t i = 0; i < kMoments; ++i) {
        const uint32_t clip = i % clip_count;
        Playback playback{.first = at_any_time(clip)};
        if (blended)
            playback.second = at_any_time((clip + 1 + i / clip_count % std::max(clip_count - 1, 1u)) % clip_count);
        for (const float weight : blended ? std::span<const float>(kWeights) : std::span<const float>(kOne)) {
            playback.weight = weight;
            out.push_back(playback);
        }
    }
    return out;
}

struct Displacement {
    double median_mm = 0, p95_mm = 0, max_mm = 0, max_of_size = 0;
};

// Of all vertices of all playbacks, between what the GPU shows and the reference of the same playback.
Displacement displacement_of(const Method& method, const Character& character, const std::vector<Playback>& playbacks) {
    constexpr double kMm = 1000;  // a unit of the model is a metre
    const Running running = method.start(playbacks);
    running.update_ms(0);
    std::vector<double> all;
    for (uint32_t i = 0; i < playbacks.size(); ++i) {
        std::vector<AffineT<double>> model_from_bind;
        for (const Affine& matrix : running.skin_matrices(i)) model_from_bind.push_back(matrix.as<double>());
        const std::vector<double> of_vertices = bench::displacements(character, playbacks[i], model_from_bind);
        all.insert(all.end(), of_vertices.begin(), of_vertices.end());
    }
    if (all.empty()) return {};
    const Spread spread = spread_of(all);
    const double largest = *std::max_element(all.begin(), all.end());
    return {spread.median * kMm, spread.p95 * kMm, largest * kMm, largest / character.size};
}

nlohmann::json record_of(const Method& method, const Character& character, const std::string& file,
                         const BaselineOptions& options) {
    uint64_t clip_bytes = 0;
    for (const Clip& clip : method.stored->clips) clip_bytes += clip.size_bytes;
    print_progress(file + ", " + method.name + ": errors");
    const Displacement sampled = displacement_of(method, character,
                                                 playbacks_to_compare(character, false, options.seed));
    const Displacement blended = displacement_of(method, character,
                                                 playbacks_to_compare(character, true, options.seed));
    return {{"bench", "baseline"},
            {"method", method.name},
            {"file", file},
            {"joints", character.rig.joint_count()},
            {"levels", character.rig.level_count},
            {"mean_depth", character.rig.mean_depth},
            {"characters", options.count},
            {"clips", character.clips.size()},
            {"bytes_per_clip", clip_bytes / character.clips.size()},
            {"bytes_all_clips", clip_bytes},
            {"rate", options.rate},
            {"samples", options.samples},
            {"sample_error_mm_median", sampled.median_mm},
            {"sample_error_mm_p95", sampled.p95_mm},
            {"sample_error_mm_max", sampled.max_mm},
            {"blend_error_mm_median", blended.median_mm},
            {"blend_error_mm_p95", blended.p95_mm},
            {"blend_error_mm_max", blended.max_mm},
            {"blend_error_of_size_max", blended.max_of_size}};
}

// Checks each method, then times them in turns: A B C A B C …; median_ms, p5_ms, p95_ms, max_error and stages.
void time_methods(const std::vector<Method>& methods, const Character& character, const BaselineOptions& options,
                  std::vector<nlohmann::json>& records) {
    const std::vector<Playback> playbacks =
        scatter({&character, 1}, {.counts = {options.count}, .seed = options.seed}).playback;
    std::vector<Running> running;
    for (size_t m = 0; m < methods.size(); ++m) {
        print_progress(character.name + ", " + methods[m].name + ": checking");
        running.push_back(methods[m].start(playbacks));
        running[m].update_ms(0);
        const double error = largest_error(methods[m], running[m], playbacks);
        if (!(error <= bench::kSkinErrorBound))
            throw CommandError(methods[m].name + ": wrong result (error " + std::to_string(error) +
                               " of the size); not timed");
        records[m]["max_error"] = error;
    }
    std::vector<std::vector<double>> total_ms(methods.size());
    std::vector<std::array<std::vector<double>, kStageNames.size()>> stage_ms(methods.size());
    for (uint32_t sample = 0; sample < options.samples; ++sample)
        for (size_t m = 0; m < methods.size(); ++m) {
            print_progress(character.name + ", " + methods[m].name + ": sample " + std::to_string(sample + 1) + " of " +
                           std::to_string(options.samples));
            total_ms[m].push_back(running[m].update_ms(1.0f / 60));
            if (!running[m].stage_times) continue;
            const StageTimes times = running[m].stage_times();
            for (size_t s = 0; s < kStageNames.size(); ++s) stage_ms[m][s].push_back(times.ms[s]);
        }
    for (size_t m = 0; m < methods.size(); ++m) {
        const Spread total = spread_of(total_ms[m]);
        records[m].update({{"median_ms", total.median}, {"p5_ms", total.p5}, {"p95_ms", total.p95}});
        for (size_t s = 0; s < kStageNames.size(); ++s)
            if (!stage_ms[m][s].empty()) records[m]["stages_ms"][kStageNames[s]] = spread_of(stage_ms[m][s]).median;
    }
}

void print_table(const std::vector<nlohmann::json>& records) {
    const nlohmann::json& first = records.front();
    const auto real = [](const nlohmann::json& record, const char* field) { return record[field].get<double>(); };
    std::printf("\n%s: %u joints, %u levels (mean depth %.1f), %u clips\n", first["file"].get<std::string>().c_str(),
                first["joints"].get<uint32_t>(), first["levels"].get<uint32_t>(), real(first, "mean_depth"),
                first["clips"].get<uint32_t>());
    std::printf("%-10s %9s %9s %9s %12s %7s   %-28s   %-28s %8s\n", "", "", "", "", "", "", "one clip, mm off",
                "two clips blended, mm off", "max of");
    std::printf("%-10s %9s %9s %9s %12s %7s   %8s %9s %9s   %8s %9s %9s %8s\n", "method", "ms", "5 %", "95 %",
                "bytes/clip", "ratio", "median", "95 %", "max", "median", "95 %", "max", "size");
    for (const nlohmann::json& record : records)
        std::printf("%-10s %9.3f %9.3f %9.3f %12.0f %7.2f   %8.4f %9.4f %9.4f   %8.3f %9.3f %9.3f %8.1e\n",
                    record["method"].get<std::string>().c_str(), real(record, "median_ms"), real(record, "p5_ms"),
                    real(record, "p95_ms"), real(record, "bytes_per_clip"),
                    real(record, "bytes_all_clips") / real(first, "bytes_all_clips"),
                    real(record, "sample_error_mm_median"), real(record, "sample_error_mm_p95"),
                    real(record, "sample_error_mm_max"), real(record, "blend_error_mm_median"),
                    real(record, "blend_error_mm_p95"), real(record, "blend_error_mm_max"),
                    real(record, "blend_error_of_size_max"));
    std::printf("  throng's stages, ms:");
    for (const char* name : kStageNames) std::printf(" %s %.3f", name, real(first["stages_ms"], name));
    std::printf("\n");
    std::fflush(stdout);
}

std::vector<nlohmann::json> compare(const Device& device, const Character& character, const std::string& file,
                                    const BaselineOptions& options) {
    if (character.clips.empty()) throw CommandError(file + ": it has no clips to bake");
    const bench::BakeSettings settings{.rate = options.rate, .limit_bytes = device.info().storage_buffer_range_bytes};
    std::vector<Character> stored;
    for (const bench::Baseline& baseline : bench::baselines()) {
        print_progress(file + ": baking, " + std::string(baseline.name));
        stored.push_back(baseline.bake(character, settings));
    }
    std::vector<Method> methods{throng_itself(device, character)};
    for (size_t i = 0; i < stored.size(); ++i)
        methods.push_back(baseline_method(device, bench::baselines()[i], stored[i]));
    std::vector<nlohmann::json> records;
    for (const Method& method : methods) records.push_back(record_of(method, character, file, options));
    time_methods(methods, character, options, records);
    for (nlohmann::json& record : records) record.update(bench::where_and_when(device.info()));
    print_progress("");
    return records;
}

void run_baselines(const BaselineOptions& options) {
    keep_inputs(options.files, {options.json});
    const Device device = open_device(options.device);
    std::string lines;
    const auto run = [&](const Character& character, const std::string& file) {
        if (character.packed)
            throw CommandError(file +
                               ": its clips are compressed, and baselines bake exact keys; give the glTF file, or "
                               "compile it with --error exact");
        const std::vector<nlohmann::json> records = compare(device, character, file, options);
        if (lines.empty())
            std::printf(
                "%u characters on %s, two clips blended in each; medians of %u updates; baked at %g frames a second\n",
                options.count, device.info().name.c_str(), options.samples, options.rate);
        print_table(records);
        for (const nlohmann::json& record : records)
            lines += record.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
    };
    for (const std::string& file : options.files) run(load_characters({file}, kExact).front(), file);
    if (options.files.empty())
        for (const uint32_t level_count : options.levels)
            run(unwrap(compile_character(
                    unwrap(make_creature(
                        {.joint_count = options.joints, .level_count = level_count, .seed = options.seed})),
                    kExact)),
                "creature");
    if (!options.json.empty()) write_file(options.json, std::as_bytes(std::span(lines)));
}

}  // namespace

void add_bench_baselines(Command bench) {
    Command command = bench.add_subcommand("baselines",
                                           "what baked and flattened clips save in time, and cost in memory and shape");
    auto options = std::make_shared<BaselineOptions>();
    command.add_option("files", options->files, "glTF 2.0 files, in metres (default: generated creatures)");
    command.add_option("--joints", options->joints, "of the generated creatures").capture_default_str();
    command.add_option("--levels", options->levels, "of the generated creatures").delimiter(',').capture_default_str();
    command.add_option("--count", options->count, "instances of each character")
        .check(range(1u, 10'000'000u))
        .capture_default_str();
    command.add_option("--samples", options->samples, "updates timed").check(range(1u, 100'000u)).capture_default_str();
    command.add_option("--rate", options->rate, "frames a second of baked clips")
        .check(range(0.1, 10'000.0))
        .capture_default_str();
    command.add_option("--seed", options->seed, "of creatures, clips, times and blends").capture_default_str();
    command
        .add_option("--json", options->json,
                    "a file for the records, one a line; their commit is taken from THRONG_COMMIT")
        .check(writable_file());
    add_device_option(command, options->device);
    command.footer(
        "Examples:\n  throng bench baselines\n  throng bench baselines --levels 15,120 --count 1000 --rate 60\n  "
        "throng bench baselines fox.glb --json baselines.jsonl");
    command.callback([options] { unwrap(as_result([&] { run_baselines(*options); })); });
}

}  // namespace throng::tools
