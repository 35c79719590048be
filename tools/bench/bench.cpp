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

// The path by which the crowd's groups are updated.
const char* path_of(const Crowd& crowd, size_t group_count) {
    size_t fused_count = 0;
    for (uint32_t group = 0; group < group_count; ++group) fused_count += crowd.path(group)->is_fused ? 1 : 0;
    return fused_count == 0 ? "staged" : fused_count == group_count ? "fused" : "both";
}

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

Json run_case(const Device& device, const std::vector<Character>& characters, const Scatter& field,
              const std::string& scan, const BenchOptions& options) {
    print_progress(scan + ": checking");
    Result<Crowd> created = Crowd::create(device, {.groups = field.groups, .path = options.path, .scan = scan});
    if (!created && created.error().code == ErrorCode::kUnsupported && options.scan == "all")
        return {{"bench", "update"}, {"scan", scan}, {"unsupported_reason", created.error().message}};
    Crowd crowd = unwrap(std::move(created));
    unwrap(crowd.set_playback(crowd.instances(), field.playback));
    unwrap(crowd.update(0));
    const double error = largest_error(crowd, field);
    check_error(scan, error);

    bench::UpdateTimes times;
    const bench::GpuLoad load(device.gpu());
    const bench::Contestant updates{scan, [&] { times.take(load, crowd); }};
    bench::run_rounds({&updates, 1}, options.samples, print_progress);
    uint64_t joints = 0;
    for (const CrowdGroup& group : field.groups)
        joints += uint64_t{group.instance_count} * group.character->rig.joint_count();
    Json stages, files = Json::array();
    for (size_t s = 0; s < stage_names().size(); ++s)
        stages[stage_names()[s]] = bench::spread_json(times.stage(s), "_ms");
    for (const Character& c : characters)
        files.push_back({{"name", c.name},
                         {"joints", c.rig.joint_count()},
                         {"levels", c.rig.level_count},
                         {"mean_depth", c.rig.mean_depth},
                         {"leaves", c.rig.leaf_count},
                         {"palette_entries", c.palette.size()},
                         {"keys", keys_text(c)}});
    Json record = bench::where_and_when(device.info());
    record.update({{"bench", "update"},
                   {"scan", scan},
                   {"path", path_of(crowd, field.groups.size())},
                   {"characters", options.count},
                   {"joints", joints},
                   {"files", files},
                   {"clips_blended", 2},
                   {"samples", options.samples},
                   {"host_samples", times.count_by_host()},
                   {"stages", stages},
                   {"total", bench::spread_json(times.total(), "_ms")},
                   {"ns_per_joint", times.total().median * 1e6 / static_cast<double>(joints)},
                   {"max_error", error},
                   {"memory_bytes", crowd.size_bytes()}});
    return record;
}

void print_update_row(const Json& record) {
    std::printf("%-18s ", text(record, "scan").c_str());
    if (print_untimed(record, "does not apply")) return;
    std::printf("%-6s", text(record, "path").c_str());
    for (const char* name : stage_names())
        std::printf(" %9.3f", real(record, std::string("stages/") + name + "/median_ms"));
    print_columns(record, {{" %9.3f", "total/median_ms"}, {" %9.2f", "ns_per_joint"}, {"  %.1e\n", "max_error"}});
}

void print_head(const Device& device, const std::vector<Character>& characters, const BenchOptions& options) {
    std::string keys;
    for (const Character& character : characters) keys += (keys.empty() ? "" : ", ") + keys_text(character);
    std::printf("%u characters on %s, two clips blended, keys %s; medians of %u updates, ms\n%-18s %-6s", options.count,
                device.info().name.c_str(), keys.c_str(), options.samples, "scan method", "path");
    for (const char* name : stage_names()) std::printf(" %9s", name);
    std::printf(" %9s %9s  %s\n", "total", "ns/joint", "error");
}

void run_bench(const BenchOptions& options) {
    std::vector<Character> characters = load_characters(options.files, options.compile);
    if (characters.empty())
        characters.push_back(unwrap(compile_character(unwrap(make_creature(options.creature)), options.compile)));
    const Device device = open_device(options.device);
    const Scatter field = scatter(characters,
                                  {.counts = deal_out(options.count, characters.size()), .seed = options.seed});
    std::vector<std::string> scans{options.scan};
    if (options.scan == "all") {
        scans.clear();
        for (const ScanMethodInfo& method : scan_methods())
            if (method.in_crowds) scans.push_back(method.name);
    }
    if (!options.json) print_head(device, characters, options);
    Measured measured(options.json);
    for (const std::string& scan : scans) {
        const Json record = run_case(device, characters, field, scan, options);
        measured.add({&record, 1}, [&] { print_update_row(record); });
    }
}

}  // namespace

void add_bench(Command app) {
    Command command = app.add_subcommand(kBench.command, kBench.description);
    auto options = std::make_shared<BenchOptions>();
    command.add_option("files", options->files, "glTF 2.0 files (default: a generated creature)");
    command.add_option("--joints", options->creature.joint_count, "of the generated creature").capture_default_str();
    command.add_option("--levels", options->creature.level_count, "of the generated creature").capture_default_str();
    command.add_option("--seed", options->seed, "of clips, times and blends").capture_default_str();
    command.add_option("--count", options->count, "characters in all")
        .check(range(1u, 10'000'000u))
        .capture_default_str();
    add_samples_option(command, options->samples);
    add_path_option(command, options->path);
    add_error_option(command, options->compile);
    command.add_option("--scan", options->scan, "method of the Hierarchy-Scan, or all of them")
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
