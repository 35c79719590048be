// throng bench baselines: what baking saves, and what it costs.
#include "base/failure.h"
#include "bench/baselines/baselines.h"
#include "bench/rounds.h"
#include "bench/updates.h"
#include "tools/cli/command.h"
#include "tools/creatures/creature.h"
#include "tools/creatures/creature_math.h"
#include "tools/cli/inputs.h"
#include "tools/bench/bench_commands.h"
#include "tools/bench/measured.h"
#include "tools/scene/scatter.h"

#include <algorithm>
#include <cstdio>
#include <deque>

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

// throng's update, or a baseline's.
struct Method {
    std::string name;
    const Character* stored = nullptr;          // the clips as the method stores them
    const bench::Baseline* baseline = nullptr;  // none: throng itself

    std::vector<AffineT<double>> definition(const Playback& playback) const {
        return baseline ? baseline->skin_matrices(*stored, playback)
                        : unwrap(reference_pose(*stored, playback)).model_from_bind;
    }
};

// Instances of a character under one method.
class Running {
public:
    Running(const Device& device, const Method& method, std::span<const Playback> playbacks) : load_(device.gpu()) {
        if (method.baseline) {
            baseline_.emplace(device.gpu(), *method.baseline, *method.stored, playbacks);
            return;
        }
        // On the device's shaders, like the baselines, even if a software device would update natively.
        crowd_ = unwrap(Crowd::create(device, {.groups = {{method.stored, static_cast<uint32_t>(playbacks.size())}},
                                               .path = UpdatePath::kDevice}));
        unwrap(crowd_->set_playback(crowd_->instances(), playbacks));
    }

    void update(float time_step_s) {
        if (crowd_)
            unwrap(crowd_->update(time_step_s));
        else
            baseline_->update(time_step_s);
    }
    void take_sample() {
        if (crowd_) {
            times.take(load_, *crowd_);
        } else {
            load_.run();
            times.take(baseline_->update(bench::kFrame_s));
        }
    }
    std::vector<Affine> skin_matrices(uint32_t instance) {
        return crowd_ ? unwrap(crowd_->read_skin_matrices({instance})) : baseline_->read_skin_matrices(instance);
    }
    bool has_stages() const { return crowd_.has_value(); }

    bench::UpdateTimes times;

private:
    bench::GpuLoad load_;
    std::optional<Crowd> crowd_;
    std::optional<bench::BaselineCrowd> baseline_;
};

// Playbacks of each clip at random times, or of two clips with each of the weights; the two differ if the character has
// several.
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

// How far all vertices, at 32 moments, are from where the reference of the same playback has them, mm.
Json errors_of(const Device& device, const Method& method, const Character& character, bool blended, uint64_t seed) {
    constexpr double kMm = 1000;  // a unit of the model is a metre
    const std::vector<Playback> playbacks = playbacks_to_compare(character, blended, seed);
    Running running(device, method, playbacks);
    running.update(0);
    std::vector<double> all;
    for (uint32_t i = 0; i < playbacks.size(); ++i) {
        std::vector<AffineT<double>> model_from_bind;
        for (const Affine& matrix : running.skin_matrices(i)) model_from_bind.push_back(matrix.as<double>());
        const std::vector<double> of_vertices = bench::displacements(character, playbacks[i], model_from_bind);
        all.insert(all.end(), of_vertices.begin(), of_vertices.end());
    }
    const Spread spread = spread_of(all);
    const double largest = all.empty() ? 0 : std::ranges::max(all);
    const std::string name = blended ? "blend_error_" : "sample_error_";
    Json record{{name + "mm_median", spread.median * kMm},
                {name + "mm_p95", spread.p95 * kMm},
                {name + "mm_max", largest * kMm}};
    if (blended) record[name + "of_size_max"] = largest / character.size;
    return record;
}

Json record_of(const Device& device, const Method& method, const Character& character, const std::string& file,
               const BaselineOptions& options) {
    uint64_t clip_bytes = 0;
    for (const Clip& clip : method.stored->clips) clip_bytes += clip.size_bytes;
    Json record = bench::where_and_when(device.info());
    record.update({{"bench", "baseline"},
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
                   {"samples", options.samples}});
    print_progress(file + ", " + method.name + ": errors");
    for (const bool blended : {false, true}) record.update(errors_of(device, method, character, blended, options.seed));
    return record;
}

// Checks each method, then times them in turns: A B C A B C … Adds median_ms, p5_ms, p95_ms, max_error and stages_ms to
// the records.
void time_methods(const Device& device, const std::vector<Method>& methods, const Character& character,
                  const BaselineOptions& options, std::vector<Json>& records) {
    const std::vector<Playback> playbacks =
        scatter({&character, 1}, {.counts = {options.count}, .seed = options.seed}).playback;
    std::deque<Running> running;
    std::vector<bench::TimedRun> timed_runs;
    for (size_t m = 0; m < methods.size(); ++m) {
        const std::string name = character.name + ", " + methods[m].name;
        print_progress(name + ": checking");
        Running& one = running.emplace_back(device, methods[m], playbacks);
        one.update(0);
        const double error = bench::largest_error_of_some(options.count, [&](uint32_t instance) {
            return bench::skin_error(one.skin_matrices(instance), methods[m].definition(playbacks[instance]),
                                     methods[m].stored->size);
        });
        check_error(methods[m].name, error);
        records[m]["max_error"] = error;
        timed_runs.push_back({name, [&one] { one.take_sample(); }});
    }
    bench::run_rounds(timed_runs, options.samples, print_progress);
    for (size_t m = 0; m < methods.size(); ++m) {
        const bench::UpdateTimes& times = running[m].times;
        records[m].update(bench::spread_json(times.total(), "_ms"));
        for (size_t s = 0; running[m].has_stages() && s < stage_names().size(); ++s)
            records[m]["stages_ms"][stage_names()[s]] = times.stage(s).median;
    }
}

void print_baselines_table(const std::vector<Json>& records) {
    const Json& first = records.front();
    std::printf("\n%s:", text(first, "file").c_str());
    print_columns(first, {{" %.0f joints", "joints"},
                          {", %.0f levels", "levels"},
                          {" (mean depth %.1f)", "mean_depth"},
                          {", %.0f clips\n", "clips"}});
    std::printf("%61s   %-28s   %-28s %8s\n", "", "one clip, mm off", "two clips blended, mm off", "max of");
    std::printf("%-10s %9s %9s %9s %12s %7s   %8s %9s %9s   %8s %9s %9s %8s\n", "method", "ms", "5 %", "95 %",
                "bytes/clip", "ratio", "median", "95 %", "max", "median", "95 %", "max", "size");
    for (const Json& record : records) {
        std::printf("%-10s", text(record, "method").c_str());
        print_columns(record, {{" %9.3f", "median_ms"},
                               {" %9.3f", "p5_ms"},
                               {" %9.3f", "p95_ms"},
                               {" %12.0f", "bytes_per_clip"},
                               {" %7.2f", "bytes_all_clips", 1 / real(first, "bytes_all_clips")},
                               {"   %8.4f", "sample_error_mm_median"},
                               {" %9.4f", "sample_error_mm_p95"},
                               {" %9.4f", "sample_error_mm_max"},
                               {"   %8.3f", "blend_error_mm_median"},
                               {" %9.3f", "blend_error_mm_p95"},
                               {" %9.3f", "blend_error_mm_max"},
                               {" %8.1e\n", "blend_error_of_size_max"}});
    }
    std::printf("  throng's stages, ms:");
    for (const char* name : stage_names())
        if (const double ms = real(first, std::string("stages_ms/") + name); ms > 0) std::printf(" %s %.3f", name, ms);
    std::printf("\n");
}

std::vector<Json> compare(const Device& device, const Character& character, const std::string& file,
                          const BaselineOptions& options) {
    if (character.clips.empty()) throw CommandError(file + ": has no clips to bake");
    const bench::BakeSettings settings{.rate = options.rate, .limit_bytes = device.info().storage_buffer_range_bytes};
    std::vector<Character> stored;
    for (const bench::Baseline& baseline : bench::baselines()) {
        print_progress(file + ": baking, " + std::string(baseline.name));
        stored.push_back(baseline.bake(character, settings));
    }
    std::vector<Method> methods{{"throng", &character}};
    for (size_t i = 0; i < stored.size(); ++i) {
        const bench::Baseline& baseline = bench::baselines()[i];
        methods.push_back({std::string(baseline.name), &stored[i], &baseline});
    }
    std::vector<Json> records;
    for (const Method& method : methods) records.push_back(record_of(device, method, character, file, options));
    time_methods(device, methods, character, options, records);
    return records;
}

void run_baselines(const BaselineOptions& options) {
    protect_inputs(options.files, {options.json});
    const Device device = open_vulkan_device(options.device);
    Measured measured;
    const auto run = [&](const Character& character, const std::string& file) {
        if (character.packed)
            throw CommandError(file +
                               ": its clips are compressed, and baselines bake exact keys; give the glTF file, or "
                               "compile it with --error exact");
        const std::vector<Json> records = compare(device, character, file, options);
        measured.add(records, [&] {
            if (measured.all().empty())
                std::printf(
                    "%u characters on %s, two clips blended in each; medians of %u updates; baked at %g frames a "
                    "second\n",
                    options.count, device.info().name.c_str(), options.samples, options.rate);
            print_baselines_table(records);
        });
        // After each character, so that a long run that is stopped keeps its results
        if (!options.json.empty()) write_text(options.json, measured.lines());
    };
    for (const std::string& file : options.files) run(load_characters({file}, kExact).front(), file);
    if (options.files.empty())
        for (const uint32_t level_count : options.levels)
            run(unwrap(compile_character(
                    unwrap(make_creature(
                        {.joint_count = options.joints, .level_count = level_count, .seed = options.seed})),
                    kExact)),
                "creature");
}

}  // namespace

void add_bench_baselines(Command bench) {
    Command command = bench.add_subcommand("baselines",
                                           "what baked and flattened clips save in time, and cost in memory and shape");
    auto options = std::make_shared<BaselineOptions>();
    Option files = command.add_option("files", options->files,
                                      "glTF 2.0 files, in metres (default: generated creatures)");
    command.add_option("--joints", options->joints, "joints of the generated creatures")
        .excludes(files)
        .capture_default_str();
    command.add_option("--levels", options->levels, "levels of the generated creatures")
        .excludes(files)
        .delimiter(',')
        .capture_default_str();
    command.add_option("--count", options->count, "instances of each character")
        .check(range(1u, 10'000'000u))
        .capture_default_str();
    add_samples_option(command, options->samples);
    command.add_option("--rate", options->rate, "frames a second of baked clips")
        .check(range(0.1, 10'000.0))
        .capture_default_str();
    command.add_option("--seed", options->seed, "seed of creatures, clips, times and blends").capture_default_str();
    add_json_file_option(command, options->json);
    add_device_option(command, options->device);
    command.footer(
        "Examples:\n  throng bench baselines\n  throng bench baselines --levels 15,120 --count 1000 --rate 60\n  "
        "throng bench baselines fox.glb --json baselines.jsonl");
    command.callback([options] { unwrap(as_result([&] { run_baselines(*options); })); });
}

}  // namespace throng::tools
