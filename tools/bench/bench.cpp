#include "bench/record.h"
#include "bench/skin_error.h"
#include "tools/cli/statistics.h"
#include "tools/cli/command.h"
#include "tools/cli/program.h"
#include "tools/creatures/creature.h"
#include "tools/bench/bench_commands.h"
#include "tools/scene/scatter.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
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

nlohmann::json spread_record(const std::vector<double>& values) {
    const Spread spread = spread_of(values);
    return {{"median_ms", spread.median}, {"p5_ms", spread.p5}, {"p95_ms", spread.p95}};
}

// What its groups are updated by.
const char* path_of(const Crowd& crowd, size_t group_count) {
    size_t fused_count = 0;
    for (uint32_t group = 0; group < group_count; ++group) fused_count += crowd.path(group)->is_fused ? 1 : 0;
    return fused_count == 0 ? "staged" : fused_count == group_count ? "fused" : "both";
}

// Of some instances of each group.
double largest_error(Crowd& crowd, const Scatter& field) {
    double worst = 0;
    uint32_t first = 0;
    for (const CrowdGroup& group : field.groups) {
        constexpr uint32_t kChecked = 16;
        for (uint32_t i = 0; i < std::min(kChecked, group.instance_count); ++i) {
            const auto instance = static_cast<uint32_t>(first + uint64_t{group.instance_count} * i /
                                                                    std::min(kChecked, group.instance_count));
            const ReferencePose pose = unwrap(reference_pose(*group.character, field.playback[instance]));
            worst = std::max(worst, bench::skin_error(unwrap(crowd.read_skin_matrices(instance)), pose.model_from_bind,
                                                      group.character->size));
        }
        first += group.instance_count;
    }
    return worst;
}

nlohmann::json run_case(const Device& device, const std::vector<Character>& characters, const Scatter& field,
                        const std::string& scan, const BenchOptions& options) {
    print_progress(scan + ": checking");
    Result<Crowd> created = Crowd::create(device, {.groups = field.groups, .path = options.path, .scan = scan});
    if (!created && created.error().code == ErrorCode::kUnsupported && options.scan == "all")
        return {{"bench", "update"}, {"scan", scan}, {"unsupported_reason", created.error().message}};
    Crowd crowd = unwrap(std::move(created));
    unwrap(crowd.set_playback(0, field.playback));
    unwrap(crowd.update(0));
    const double error = largest_error(crowd, field);
    if (!(error <= bench::kSkinErrorBound))
        throw CommandError(scan + ": wrong result (error " + std::to_string(error) + " of the size); not timed");

    std::array<std::vector<double>, kStageNames.size()> stage_ms;
    std::vector<double> total_ms;
    for (uint32_t sample = 0; sample < options.samples; ++sample) {
        print_progress(scan + ": sample " + std::to_string(sample + 1) + " of " + std::to_string(options.samples));
        unwrap(crowd.update(1.0f / 60));
        const StageTimes times = unwrap(crowd.stage_times());
        for (size_t s = 0; s < kStageNames.size(); ++s) stage_ms[s].push_back(times.ms[s]);
        total_ms.push_back(times.total());
    }
    uint64_t joints = 0;
    for (const CrowdGroup& group : field.groups)
        joints += uint64_t{group.instance_count} * group.character->rig.joint_count();
    nlohmann::json stages;
    for (size_t s = 0; s < kStageNames.size(); ++s) stages[kStageNames[s]] = spread_record(stage_ms[s]);
    nlohmann::json files = nlohmann::json::array();
    for (const Character& c : characters)
        files.push_back({{"name", c.name},
                         {"joints", c.rig.joint_count()},
                         {"levels", c.rig.level_count},
                         {"mean_depth", c.rig.mean_depth},
                         {"leaves", c.rig.leaf_count},
                         {"palette_entries", c.palette.size()},
                         {"keys", keys_text(c)}});
    const nlohmann::json total = spread_record(total_ms);
    nlohmann::json record = bench::where_and_when(device.info());
    record.update({{"bench", "update"},
                   {"scan", scan},
                   {"path", path_of(crowd, field.groups.size())},
                   {"characters", options.count},
                   {"joints", joints},
                   {"files", files},
                   {"clips_blended", 2},
                   {"samples", options.samples},
                   {"stages", stages},
                   {"total", total},
                   {"ns_per_joint", total["median_ms"].get<double>() * 1e6 / static_cast<double>(joints)},
                   {"max_error", error},
                   {"memory_bytes", crowd.size_bytes()}});
    return record;
}

void print_row(const nlohmann::json& record) {
    if (record.contains("unsupported_reason")) {
        std::printf("%-18s does not apply: %s\n", record["scan"].get<std::string>().c_str(),
                    record["unsupported_reason"].get<std::string>().c_str());
        return;
    }
    std::printf("%-18s %-6s", record["scan"].get<std::string>().c_str(), record["path"].get<std::string>().c_str());
    for (const char* name : kStageNames) std::printf(" %9.3f", record["stages"][name]["median_ms"].get<double>());
    std::printf(" %9.3f %9.2f  %.1e\n", record["total"]["median_ms"].get<double>(),
                record["ns_per_joint"].get<double>(), record["max_error"].get<double>());
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
    if (!options.json) {
        std::string keys;
        for (const Character& character : characters) keys += (keys.empty() ? "" : ", ") + keys_text(character);
        std::printf("%u characters on %s, two clips blended, keys %s; medians of %u updates, ms\n%-18s %-6s",
                    options.count, device.info().name.c_str(), keys.c_str(), options.samples, "scan method", "path");
        for (const char* name : kStageNames) std::printf(" %9s", name);
        std::printf(" %9s %9s  %s\n", "total", "ns/joint", "error");
    }
    for (const std::string& scan : scans) {
        const nlohmann::json record = run_case(device, characters, field, scan, options);
        print_progress("");
        if (options.json)
            print_json(record);
        else
            print_row(record);
        std::fflush(stdout);
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
    command.add_option("--samples", options->samples, "updates timed").check(range(1u, 100'000u)).capture_default_str();
    add_path_option(command, options->path);
    add_error_option(command, options->compile);
    command.add_option("--scan", options->scan, "method of the Hierarchy-Scan, or all of them")
        .check(scan_name({"all", "auto"}))
        .capture_default_str();
    add_device_option(command, options->device);
    command.add_flag("--json", options->json, "a JSON record a line; its commit is taken from THRONG_COMMIT");
    command.footer(
        "Examples:\n  throng bench\n  throng bench --joints 300 --levels 120 --count 1000 --scan serial\n  throng "
        "bench fox.glb --count 5000 --json");
    add_bench_frame(command);
    add_bench_control(command);
    add_bench_view(command);
    add_bench_scan(command);
    add_bench_baselines(command);
    add_bench_report(command);
    add_bench_diagrams(command);
    command.callback([options, command] {
        if (!command.has_subcommand()) run_bench(*options);
    });
}

}  // namespace throng::tools
