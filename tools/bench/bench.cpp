#include "bench/rounds.h"
#include "bench/updates.h"
#include "tools/cli/command.h"
#include "tools/cli/program.h"
#include "tools/creatures/creature.h"
#include "tools/bench/bench_commands.h"
#include "tools/bench/measured.h"
#include "tools/scene/scatter.h"

#include <algorithm>
#include <cstdio>
#include <optional>
#include <utility>

namespace throng::tools {
namespace {

struct BenchOptions {
    std::vector<std::string> files;
    CreatureSettings creature;
    std::string scan = "all", device;
    UpdatePath path = UpdatePath::kStaged;  // which has a time for each stage
    CompileSettings compile;
    uint32_t count = 10'000, samples = 15;
    uint64_t seed = 1;
    bool json = false;
};

double largest_error(Crowd& crowd, const Scatter& field) {
    double worst = 0;
    uint32_t first = 0;
    for (const CrowdGroup& group : field.groups) {
        const auto error_of = [&](uint32_t instance) {
            const ReferencePose pose = unwrap(reference_pose(*group.character, field.playback[first + instance]));
            return bench::skin_error(unwrap(crowd.read_skin_matrices({first + instance})), pose.model_from_bind,
                                     group.character->size);
        };
        worst = std::max(worst, bench::largest_error_of_some(group.instance_count, error_of));
        first += group.instance_count;
    }
    return worst;
}

Json files_of(const std::vector<Character>& characters) {
    Json files = Json::array();
    for (const Character& c : characters)
        files.push_back({{"name", c.name},
                         {"joints", c.rig.joint_count()},
                         {"levels", c.rig.level_count},
                         {"mean_depth", c.rig.mean_depth},
                         {"leaves", c.rig.leaf_count},
                         {"palette_entries", c.palette.size()},
                         {"keys", keys_text(c)}});
    return files;
}

void print_update_row(const Json& record) {
    std::printf("%-19s ", text(record, "scan").c_str());
    if (print_untimed(record, "does not apply")) return;
    std::printf("%-13s", text(record, "path").c_str());
    for (const char* name : stage_names())
        std::printf(" %9.3f", real(record, std::string("stages/") + name + "/median_ms"));
    print_columns(record, {{" %9.3f", "total/median_ms"}, {" %9.2f", "ns_per_joint"}, {"  %.1e\n", "max_error"}});
}

// Runs updates by each scan method in turns, with as many methods at a time as there is memory for.
class MethodRun {
public:
    MethodRun(const BenchOptions& options, const std::vector<Character>& characters)
        : options_(options),
          device_(open_device(options.device)),
          load_(device_.gpu()),
          field_(scatter(characters, {.counts = deal_out(options.count, characters.size()), .seed = options.seed})),
          files_(files_of(characters)),
          measured_(options.json) {}

    const Device& device() const { return device_; }

    // If a method fails, the methods before it are still timed and shown.
    void run(const std::vector<std::string>& scans) {
        try {
            for (const std::string& scan : scans) {
                if (!fits_another()) time_group();
                group_.push_back(check(scan));
            }
        } catch (...) {
            time_group();
            throw;
        }
        time_group();
        measured_.finish("", "a scan method");
    }

private:
    struct Method {
        Json record;
        std::optional<Crowd> crowd{};  // none if the method does not apply or is wrong
        bench::UpdateTimes times{};
    };

    // Assumes that the next crowd is about as large as the last. Leaves half of the memory to everything else.
    bool fits_another() const {
        uint64_t held_bytes = 0, last_bytes = 0;
        for (const Method& method : group_) {
            if (!method.crowd) continue;
            last_bytes = method.crowd->size_bytes();
            held_bytes += last_bytes;
        }
        return held_bytes + last_bytes <= device_.gpu()->largest_heap_bytes() / 2;
    }

    Method check(const std::string& scan) {
        print_progress(scan + ": checking");
        Method method{.record = bench::where_and_when(device_.info())};
        Json& record = method.record;
        record.update({{"bench", "update"}, {"scan", scan}});
        Result<Crowd> created = Crowd::create(device_, {.groups = field_.groups, .path = options_.path, .scan = scan});
        if (!created && created.error().code == ErrorCode::kUnsupported && options_.scan == "all") {
            record["unsupported_reason"] = created.error().message;
            return method;
        }
        Crowd crowd = unwrap(std::move(created));
        unwrap(crowd.set_playback(crowd.instances(), field_.playback));
        unwrap(crowd.update(0));
        const double error = largest_error(crowd, field_);
        record.update({{"path", bench::path_name(crowd)},
                       {"characters", options_.count},
                       {"joints", joint_count()},
                       {"files", files_},
                       {"clips_blended", 2},
                       {"max_error", error},
                       {"memory_bytes", crowd.size_bytes()}});
        if (error <= bench::kSkinErrorBound)
            method.crowd = std::move(crowd);
        else
            record["wrong"] = true;
        return method;
    }

    void time_group() {
        std::vector<Method> group = std::exchange(group_, {});
        std::vector<bench::TimedRun> timed_runs;
        for (Method& method : group)
            if (method.crowd)
                timed_runs.push_back({text(method.record, "scan"), [&] { method.times.take(load_, *method.crowd); }});
        try {
            bench::run_rounds(timed_runs, options_.samples, print_progress);
        } catch (...) {
            add(group);
            throw;
        }
        add(group);
    }

    // Leaves out methods that were not timed because another one failed before their turn.
    void add(std::vector<Method>& group) {
        for (Method& method : group) {
            if (method.crowd && method.times.count() == 0) continue;
            if (method.crowd) add_times(method.record, method.times);
            measured_.add({&method.record, 1}, [&] { print_update_row(method.record); });
        }
    }

    uint64_t joint_count() const {
        uint64_t joints = 0;
        for (const CrowdGroup& group : field_.groups)
            joints += uint64_t{group.instance_count} * group.character->rig.joint_count();
        return joints;
    }

    void add_times(Json& record, const bench::UpdateTimes& times) const {
        Json stages;
        for (size_t s = 0; s < stage_names().size(); ++s)
            stages[stage_names()[s]] = bench::spread_json(times.stage(s), "_ms");
        record.update({{"samples", times.count()},
                       {"host_samples", times.count_by_host()},
                       {"stages", stages},
                       {"total", bench::spread_json(times.total(), "_ms")},
                       {"ns_per_joint", times.total().median * 1e6 / static_cast<double>(joint_count())}});
    }

    const BenchOptions& options_;
    const Device device_;
    const bench::GpuLoad load_;
    const Scatter field_;
    const Json files_;
    Measured measured_;
    std::vector<Method> group_;  // whose crowds exist
};

void print_head(const Device& device, const std::vector<Character>& characters, const BenchOptions& options) {
    std::string keys;
    for (const Character& character : characters) keys += (keys.empty() ? "" : ", ") + keys_text(character);
    std::printf("%u characters on %s, two clips blended, keys %s; medians of %u updates, ms\n%-19s %-13s",
                options.count, device.info().name.c_str(), keys.c_str(), options.samples, "scan method", "path");
    for (const char* name : stage_names()) std::printf(" %9s", name);
    std::printf(" %9s %9s  %s\n", "total", "ns/joint", "error");
}

void run_bench(const BenchOptions& options) {
    std::vector<Character> characters = load_characters(options.files, options.compile);
    if (characters.empty())
        characters.push_back(unwrap(compile_character(unwrap(make_creature(options.creature)), options.compile)));
    MethodRun run(options, characters);
    std::vector<std::string> scans{options.scan};
    if (options.scan == "all") {
        scans.clear();
        for (const ScanMethodInfo& method : scan_methods())
            if (method.in_crowds) scans.push_back(method.name);
    }
    if (!options.json) print_head(run.device(), characters, options);
    run.run(scans);
}

}  // namespace

void add_bench(Command app) {
    Command command = app.add_subcommand(kBench.command, kBench.description);
    auto options = std::make_shared<BenchOptions>();
    Option files = command.add_option("files", options->files, "glTF 2.0 files (default: a generated creature)");
    command.add_option("--joints", options->creature.joint_count, "joints of the generated creature")
        .excludes(files)
        .capture_default_str();
    command.add_option("--levels", options->creature.level_count, "levels of the generated creature")
        .excludes(files)
        .capture_default_str();
    command.add_option("--seed", options->seed, "seed of clips, times and blends").capture_default_str();
    command.add_option("--count", options->count, "characters in all")
        .check(range(1u, 10'000'000u))
        .capture_default_str();
    add_samples_option(command, options->samples);
    add_path_option(command, options->path);
    add_error_option(command, options->compile);
    command.add_option("--scan", options->scan, "method of the Hierarchy-Scan, or all")
        .check(scan_name({"all", "auto"}))
        .capture_default_str();
    add_device_option(command, options->device);
    add_json_flag(command, options->json);
    command.footer(
        "Examples:\n  throng bench\n  throng bench --joints 300 --levels 120 --count 1000 --scan serial\n  throng "
        "bench fox.glb --count 5000 --json");
    add_bench_frame(command);
    add_bench_cpu(command);
    add_bench_control(command);
    add_bench_isa(command);
    add_bench_view(command);
    add_bench_million(command);
    add_bench_population(command);
    add_bench_draw(command);
    add_bench_scan(command);
    add_bench_baselines(command);
    add_bench_report(command);
    add_bench_summary(command);
    add_bench_diagrams(command);
    command.callback([options, command] {
        if (!command.has_subcommand()) run_bench(*options);
    });
}

}  // namespace throng::tools
