#include "bench/isa_bench.h"

#include "bench/frame_traffic.h"
#include "bench/isa/compiler.h"
#include "bench/isa/configurations.h"
#include "bench/isa/executable.h"
#include "bench/isa/prediction.h"
#include "bench/skeletons.h"
#include "bench/value_of.h"
#include "crowd/path.h"
#include "draw/pipeline.h"

#include <throng/device.h>

#include <algorithm>
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

// The kernels of one family, in subgroups of one size.
class IsaMeasurement {
public:
    IsaMeasurement(const Simd& simd, uint32_t subgroup_size, const Progress& progress)
        : simd_(simd), progress_(progress), gpu_(open_compiler(std::string(simd.family))) {
        gpu_->compiled_subgroup_size = subgroup_size;
        gpu_->on_pipeline = [this](const MadePipeline& made) {
            for (Executable& executable : executables_of(*gpu_, made)) made_.push_back(std::move(executable));
        };
    }
    ~IsaMeasurement() { gpu_->on_pipeline = nullptr; }

    void measure_crowds(void (*visit_forms)(const VisitIsa&)) {
        visit_forms([&](const IsaConfiguration& configuration) {
            progress_(configuration.name);
            made_.clear();
            const Crowd crowd = value_of(Crowd::create(Device(gpu_), configuration.settings));
            const PathChoice path = choose_path(*gpu_, configuration.settings, configuration.settings.groups[0]);
            for (const Executable& kernel : made_) {
                const bool is_fused = kernel.name.starts_with("fused"), is_counted = configuration.characters > 0;
                const std::span<const LoopTrips> trips = is_fused && is_counted ? path.fused->loops
                                                                                : std::span<const LoopTrips>();
                Json record = record_of(kernel, configuration.name, trips);
                if (is_fused) record["scan"] = path.fused->choice.method->name;
                add(record);
                if (is_fused && is_counted) predict_update(kernel, configuration, *path.fused);
            }
        });
    }

    void measure_scans() {
        const ScanRig rig(make_skeleton(SkeletonShape::kRandom, 300, 60, 1), true);
        const ScanLimits limits = scan_limits(*gpu_);
        for (const ScanMethod& method : scan_table())
            for (const uint32_t threads : method.thread_choices(limits)) {
                if (!plan_scan(method, rig, limits, threads).unsupported_reason.empty()) continue;
                progress_(std::string(method.name));
                made_.clear();
                const ScanStage scan(gpu_, {&method, threads}, rig, limits);
                for (const Executable& kernel : made_) {
                    Json record = record_of(kernel, "scan alone, 300 joints, 60 levels", scan.counts().loops);
                    record["threads"] = threads;
                    add(record);
                }
            }
    }

    void measure_drawing() {
        progress_("drawing");
        made_.clear();
        const ShaderLayout layout = make_draw_layout(gpu_), farthest_layout = make_farthest_layout(gpu_);
        const PipelineSettings settings{gpu_, layout.get(), VK_SAMPLE_COUNT_4_BIT};
        make_ground_pipeline(settings);
        make_farthest_pipeline(gpu_, farthest_layout);
        for (const bool listed : {false, true}) {
            const LinePipelines lines(settings, listed);
            for (const SkinFormat format : {SkinFormat::kAffine, SkinFormat::kHalfAffine, SkinFormat::kSimilarity})
                const CharacterPipelines characters(settings, {.format = format, .listed = listed});
        }
        const CharacterPipelines dual(settings, {.blend = SkinBlend::kDualQuaternion});
        const CharacterPipelines skinned(settings, {.skinned = true});
        for (const Executable& stage : made_) add(record_of(stage, "drawing", {}));
    }

    const std::vector<Json>& records() const { return records_; }

private:
    // `known`: as ScanCounts::loops, or nothing where that is not known.
    Json record_of(const Executable& kernel, const std::string& configuration, std::span<const LoopTrips> known) const {
        const auto trips = trips_of(kernel.code, known, kernel.subgroup_size);
        Json record = where_and_when(gpu_->info);
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

    // Once where several configurations have the same kernel.
    void add(const Json& record) {
        Json what = record;
        what.erase("configuration");
        if (seen_.insert(what.dump()).second) records_.push_back(record);
    }

    void predict_update(const Executable& kernel, const IsaConfiguration& configuration, const FusedPlan& plan) {
        const uint32_t per_workgroup = plan.scan.instances_per_workgroup;
        const FrameTraffic traffic{.fused = true,
                                   .joint_count = configuration.character->rig.joint_count(),
                                   .palette_count = static_cast<uint32_t>(configuration.character->palette.size()),
                                   .skin_bytes = skin_format_bytes(configuration.settings.skin_format)};
        const uint32_t workgroups = (configuration.characters + per_workgroup - 1) / per_workgroup;
        const auto trips = trips_of(kernel.code, plan.loops, kernel.subgroup_size);
        const KernelWork work{
            .needs = kernel.needs(),
            .issued = trips ? issued_by_subgroup(kernel.code, *trips) : InstructionCounts(),
            .subgroups = workgroups * subgroups_of(kernel.needs()),
            .bytes = static_cast<double>(configuration.characters) * static_cast<double>(traffic.bytes_per_instance())};
        for (const Machine& machine : machines()) {
            if (machine.code != simd_.family || kernel.subgroup_size > machine.simd->largest_subgroup) continue;
            Json record = where_and_when(gpu_->info);
            record.update({{"bench", "isa"},
                           {"family", simd_.family},
                           {"configuration", configuration.name},
                           {"kernel", kernel.name},
                           {"scan", plan.choice.method->name},
                           {"subgroup_size", kernel.subgroup_size},
                           {"characters", configuration.characters},
                           {"joints", configuration.character->rig.joint_count()},
                           {"machine", machine.name},
                           {"bytes", work.bytes}});
            if (trips)
                add_prediction(record, work, predict(work, machine));
            else
                record["unsupported_reason"] = "the machine code has loops that the plan does not know";
            records_.push_back(record);
        }
    }

    static void add_prediction(Json& record, const KernelWork& work, const Prediction& prediction) {
        record.update({{"instructions_issued", work.issued.total() * work.subgroups},
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
    std::shared_ptr<Gpu> gpu_;
    std::vector<Executable> made_;  // since it was cleared
    std::vector<Json> records_;
    std::set<std::string> seen_;
};

}  // namespace

std::vector<Json> measure_isa(const std::string& family, IsaScope scope, const Progress& progress) {
    std::vector<Json> records;
    const Simd& simd = *find_family(family);
    for (const uint32_t subgroup_size : {64, 32}) {
        if (subgroup_size < simd.smallest_subgroup) continue;
        IsaMeasurement measurement(simd, subgroup_size, progress);
        measurement.measure_crowds(visit_default_forms);
        if (scope == IsaScope::kAll) {
            measurement.measure_crowds(visit_other_forms);
            measurement.measure_scans();
            measurement.measure_drawing();
        }
        records.insert(records.end(), measurement.records().begin(), measurement.records().end());
    }
    return records;
}

}  // namespace throng::bench
