#include "bench/isa_bench.h"

#include "bench/frame_traffic.h"
#include "bench/isa/configurations.h"
#include "bench/isa/scan_works.h"
#include "bench/skeletons.h"
#include "bench/value_of.h"
#include "crowd/path.h"
#include "draw/pipeline.h"

#include <throng/device.h>

#include <algorithm>
#include <map>
#include <set>

namespace throng::bench {
namespace {

Json json_of(const InstructionCounts& counts) {
    Json json{{"all", counts.total()}};
    for (size_t i = 0; i < kInstructionClasses.size(); ++i)
        if (counts.of[i] > 0) json[kInstructionClasses[i]] = counts.of[i];
    return json;
}

Json json_of(const MachineCode& code, std::span<const LoopTrips> trips) {
    Json loops = Json::array();
    for (size_t i = 0; i < code.loops.size(); ++i) {
        Json loop = json_of(code.loops[i].own);
        loop["depth"] = code.loops[i].depth;
        if (!trips.empty()) loop.update({{"loop", trips[i].loop}, {"trips", trips[i].trips}});
        loops.push_back(loop);
    }
    return loops;
}

// As `throng bench scan` makes them.
constexpr SkeletonShape kScanShape = SkeletonShape::kRandom;
constexpr uint64_t kScanSeed = 1;

// The kernels of one family, in subgroups of one size.
class IsaMeasurement {
public:
    IsaMeasurement(const Simd& simd, uint32_t subgroup_size, const Progress& progress)
        : simd_(simd), progress_(progress), compiler_(std::string(simd.family), subgroup_size) {}

    void measure_crowds(void (*visit_forms)(const VisitIsa&)) {
        visit_forms([&](const IsaConfiguration& configuration) {
            progress_(configuration.name);
            const std::shared_ptr<Gpu>& gpu = compiler_.gpu();
            const std::vector<Executable> kernels = compiler_.made_by(
                [&] { value_of(Crowd::create(Device(gpu), configuration.settings)); });
            const PathChoice path = choose_path(*gpu, configuration.settings, configuration.settings.groups[0]);
            for (const Executable& kernel : kernels) {
                const bool is_fused = kernel.name.starts_with("fused"), is_counted = configuration.characters > 0;
                const std::span<const LoopTrips> trips = is_fused && is_counted ? path.fused->loops
                                                                                : std::span<const LoopTrips>();
                Json record = record_of(kernel, configuration.name, trips_of_kernel(kernel, trips));
                if (is_fused) record["scan"] = path.fused->choice.method->name;
                add(record);
                if (is_fused && is_counted) predict_update(kernel, configuration, *path.fused);
            }
        });
    }

    // Records, for each method and machine, the number of threads that is predicted to be fastest.
    void measure_scans(uint32_t levels) {
        const ScanRig rig(make_skeleton(kScanShape, 300, levels, kScanSeed), true);
        for (const ScanPlace place : {ScanPlace::kMemory, ScanPlace::kChip}) {
            const std::string configuration = std::string(place == ScanPlace::kMemory ? "scan alone" : "scan on chip") +
                                              ", 300 joints, " + std::to_string(levels) + " levels";
            std::map<std::string_view, std::vector<ScanWork>> of_methods;
            visit_scan_works(compiler_, rig, place, [&](const ScanWork& work) {
                progress_(configuration + ": " + name_of(work.choice));
                of_methods[work.choice.method->name].push_back(work);
            });
            for (const auto& [method, works] : of_methods) add_best(works, configuration, levels);
        }
    }

    void measure_drawing() {
        progress_("drawing");
        const std::vector<Executable> stages = compiler_.made_by([&] {
            const std::shared_ptr<Gpu>& gpu = compiler_.gpu();
            const ShaderLayout layout = make_draw_layout(gpu), farthest_layout = make_farthest_layout(gpu);
            const PipelineSettings settings{gpu, layout.get(), VK_SAMPLE_COUNT_4_BIT, color_format(false)};
            make_ground_pipeline(settings);
            make_farthest_pipeline(gpu, farthest_layout);
            for (const bool listed : {false, true}) {
                const LinePipelines lines(settings, listed);
                for (const SkinFormat format : {SkinFormat::kAffine, SkinFormat::kHalfAffine, SkinFormat::kSimilarity})
                    const CharacterPipelines characters(settings, {.format = format, .listed = listed});
            }
            const CharacterPipelines dual(settings, {.blend = SkinBlend::kDualQuaternion});
            const CharacterPipelines skinned(settings, {.skinned = true});
        });
        for (const Executable& stage : stages) add(record_of(stage, "drawing", trips_of_kernel(stage, {})));
    }

    const std::vector<Json>& records() const { return records_; }

private:
    static std::optional<std::vector<LoopTrips>> trips_of_kernel(const Executable& kernel,
                                                                 std::span<const LoopTrips> known) {
        return trips_of(kernel.code, known, kernel.subgroup_size);
    }

    // `trips`: of each loop, if known.
    Json record_of(const Executable& kernel, const std::string& configuration,
                   const std::optional<std::vector<LoopTrips>>& trips) const {
        Json record = where_and_when(compiler_.gpu()->info);
        const Occupancy occupancy = occupancy_of(kernel.needs(), simd_);
        record.update({{"bench", "isa"},
                       {"family", simd_.family},
                       {"configuration", configuration},
                       {"kernel", kernel.name},
                       {"subgroup_size", kernel.subgroup_size},
                       {"workgroup_size", kernel.workgroup_size},
                       {"vgprs", kernel.vgprs},
                       {"sgprs", kernel.sgprs},
                       {"spilled_vgprs", kernel.spilled_vgprs},
                       {"spilled_sgprs", kernel.spilled_sgprs},
                       {"scratch_bytes", kernel.scratch_bytes},
                       {"shared_bytes", kernel.shared_bytes},
                       {"subgroups_per_simd", occupancy.subgroups},
                       {"limited_by", occupancy.limit},
                       {"instructions", json_of(kernel.code.all())},
                       {"loops", json_of(kernel.code, trips.value_or(std::vector<LoopTrips>()))}});
        if (trips) record["issued"] = json_of(issued_by_subgroup(kernel.code, *trips));
        return record;
    }

    // Adds a kernel once if several configurations have the same one.
    void add(const Json& record) {
        Json what = record;
        what.erase("configuration");
        if (seen_.insert(what.dump()).second) records_.push_back(record);
    }

    bool stands_for(const Executable& kernel, const Machine& machine) const {
        return machine.code == simd_.family && kernel.subgroup_size <= machine.simd->largest_subgroup;
    }

    void add_best(std::span<const ScanWork> works, const std::string& configuration, uint32_t levels) {
        constexpr uint32_t kCharacters = 10'000;
        for (const Machine& machine : machines()) {
            const auto ms = [&](const ScanWork& work) { return predict(work.of(kCharacters), machine).ms(); };
            const auto best = std::ranges::min_element(works, {}, ms);
            if (!stands_for(best->kernel, machine)) continue;
            Json record = record_of(best->kernel, configuration, best->trips);
            record["threads"] = best->choice.threads;
            add(record);
            record = prediction_of(best->kernel, configuration, machine);
            record.update({{"scan", best->choice.method->name},
                           {"threads", best->choice.threads},
                           {"characters", kCharacters},
                           {"joints", best->joint_count},
                           {"levels", levels},
                           {"shape", name_of(kScanShape)},
                           {"seed", kScanSeed}});
            add_prediction(record, best->of(kCharacters), predict(best->of(kCharacters), machine));
            records_.push_back(record);
        }
    }

    Json prediction_of(const Executable& kernel, const std::string& configuration, const Machine& machine) const {
        Json record = where_and_when(compiler_.gpu()->info);
        record.update({{"bench", "isa"},
                       {"family", simd_.family},
                       {"configuration", configuration},
                       {"kernel", kernel.name},
                       {"subgroup_size", kernel.subgroup_size},
                       {"machine", machine.name}});
        return record;
    }

    void predict_update(const Executable& kernel, const IsaConfiguration& configuration, const FusedPlan& plan) {
        const uint32_t per_workgroup = plan.scan.instances_per_workgroup;
        const FrameTraffic traffic{.fused = true,
                                   .joint_count = configuration.character->rig.joint_count(),
                                   .palette_count = static_cast<uint32_t>(configuration.character->palette.size()),
                                   .skin_bytes = skin_format_bytes(configuration.settings.skin_format)};
        const uint32_t workgroups = (configuration.characters + per_workgroup - 1) / per_workgroup;
        const auto trips = trips_of_kernel(kernel, plan.loops);
        const KernelWork work{
            .needs = kernel.needs(),
            .issued = trips ? issued_by_subgroup(kernel.code, *trips) : InstructionCounts(),
            .subgroups = workgroups * subgroups_of(kernel.needs()),
            .bytes = static_cast<double>(configuration.characters) * static_cast<double>(traffic.bytes_per_instance())};
        for (const Machine& machine : machines()) {
            if (!stands_for(kernel, machine)) continue;
            Json record = prediction_of(kernel, configuration.name, machine);
            record.update({{"scan", plan.choice.method->name},
                           {"characters", configuration.characters},
                           {"joints", configuration.character->rig.joint_count()}});
            if (trips)
                add_prediction(record, work, predict(work, machine));
            else
                record["unsupported_reason"] = "the loops of the machine code do not match those that the plan counts";
            records_.push_back(record);
        }
    }

    static void add_prediction(Json& record, const KernelWork& work, const Prediction& prediction) {
        record.update({{"bytes", work.bytes},
                       {"instructions_issued", work.issued.total() * work.subgroups},
                       {"subgroups_per_simd", prediction.occupancy.subgroups},
                       {"limited_by", prediction.occupancy.limit},
                       {"predicted_issue_ms", prediction.issue_ms},
                       {"predicted_latency_ms", prediction.latency_ms},
                       {"predicted_memory_ms", prediction.memory_ms},
                       {"predicted_ms", prediction.ms()},
                       {"predicted_limit", prediction.limit()}});
    }

    const Simd& simd_;
    const Progress& progress_;
    Compiler compiler_;
    std::vector<Json> records_;
    std::set<std::string> seen_;
};

}  // namespace

std::vector<Json> measure_isa(const std::string& family, IsaScope scope, const Progress& progress) {
    std::vector<Json> records;
    const Simd& simd = *find_family(family);
    for (const uint32_t subgroup_size : {64u, 32u}) {
        if (subgroup_size < simd.smallest_subgroup) continue;
        IsaMeasurement measurement(simd, subgroup_size, progress);
        measurement.measure_crowds(visit_default_forms);
        if (scope == IsaScope::kAll) {
            measurement.measure_crowds(visit_other_forms);
            if (subgroup_size == std::max(simd.smallest_subgroup, 32u))
                for (const uint32_t levels : {15u, 30u, 60u, 120u}) measurement.measure_scans(levels);
            measurement.measure_drawing();
        }
        records.insert(records.end(), measurement.records().begin(), measurement.records().end());
    }
    return records;
}

}  // namespace throng::bench
