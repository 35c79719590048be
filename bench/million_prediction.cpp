#include "bench/million_prediction.h"

#include "base/failure.h"
#include "bench/isa/compiler.h"
#include "bench/isa/executable.h"
#include "bench/isa/prediction.h"
#include "bench/value_of.h"
#include "control/control_io.h"
#include "crowd/path.h"
#include "cull/cull.h"

#include <throng/device.h>

#include <algorithm>
#include <bit>
#include <cmath>

namespace throng::bench {
namespace {

constexpr uint32_t kSubgroup = 32;

// The kernels of such a crowd.
class MillionKernels {
public:
    MillionKernels(const std::string& family, const Character& character, const SkinPool& pool)
        : gpu_(open_compiler(family)), character_(character) {
        gpu_->compiled_subgroup_size = kSubgroup;
        gpu_->on_pipeline = [this](const MadePipeline& made) {
            for (Executable& executable : executables_of(*gpu_, made)) made_.push_back(std::move(executable));
        };
        const CrowdSettings settings{.groups = {{.character = &character, .instance_count = 1, .skin_pool = pool}},
                                     .timestamps = false};
        CrowdSettings viewed = settings;
        viewed.culls = true;
        const Crowd crowd = value_of(Crowd::create(Device(gpu_), viewed));
        plan_ = choose_path(*gpu_, viewed, viewed.groups[0]).fused;
        gpu_->on_pipeline = nullptr;
    }

    // Milliseconds of each stage.
    Json stages(uint32_t instances, DrawnCounts drawn, const Machine& machine) const {
        const double all = instances, n = drawn.own, seen = drawn.own + drawn.shared;
        constexpr double kWord = sizeof(uint32_t);
        const uint64_t workgroups = cull_workgroups_of(instances), cells = cells_of_workgroup(instances),
                       of_invocation = (workgroups + io::kCullWorkgroupSize - 1) / io::kCullWorkgroupSize;
        const double in_seen_cells = std::min(all, double{io::kCullWorkgroupSize} * drawn.cells);
        const uint64_t searched = std::bit_width(std::ranges::max(character_.clips, {}, &Clip::row_count).row_count);
        Json stages;
        stages["control"] = ms_of("control", {{"rows", searched}, {"rows", searched}}, all,
                                  all * 2 * (sizeof(io::InstancePlayback) + sizeof(io::InstanceCursor)) / 1.5, machine);
        // Of cells their boxes; of instances in those that are seen placement and state; of all state and verdict,
        // written; of what is drawn the cursor and the row
        const double culled_bytes = sizeof(io::Cell) * std::ceil(all / io::kCullWorkgroupSize) +
                                    in_seen_cells * (sizeof(Affine) + kWord) + all * 2 * kWord +
                                    seen * (sizeof(io::InstanceCursor) + kWord);
        const auto seen_of_workgroup = static_cast<uint64_t>(
            std::ceil(static_cast<double>(cells) * in_seen_cells / all));
        const double invocations = static_cast<double>(workgroups) * io::kCullWorkgroupSize;
        const double culled = ms_of("cull", {{"cells", std::max<uint64_t>(seen_of_workgroup, 1)}}, invocations,
                                    culled_bytes, machine);
        const uint64_t fours = io::kCounters / 4, wide = io::kCullWorkgroupSize;
        const double offset = ms_of("offsets",
                                    {{"counters", fours},
                                     {"workgroups", of_invocation},
                                     {"invocations", wide},
                                     {"counters", io::kCounters},
                                     {"counters", fours},
                                     {"invocations", wide},
                                     {"workgroups", of_invocation},
                                     {"sections", 1}},
                                    io::kCullWorkgroupSize,
                                    2.0 * static_cast<double>(workgroups) * io::kCounters * kWord, machine);
        const double listed = ms_of("list", {{"cells", cells}, {"ranks", std::bit_width(wide) - 1}}, invocations,
                                    all * kWord + seen * kWord + n * 2 * kWord, machine);
        stages["cull"] = culled + offset + listed;
        stages["offsets"] = offset;
        stages["fused"] = fused_ms(n, machine);
        return stages;
    }

private:
    const Executable& kernel(std::string_view name) const {
        return *std::ranges::find_if(made_, [&](const Executable& one) { return one.name == name; });
    }

    double ms_of(std::string_view name, const std::vector<LoopTrips>& known, double invocations, double bytes,
                 const Machine& machine) const {
        const Executable& of = kernel(name);
        const auto trips = trips_of(of.code, known, of.subgroup_size);
        if (!trips)
            throw Failure(ErrorCode::kUnsupported, "prediction",
                          std::string(name) + " has " + std::to_string(of.code.loops.size()) + " loops, " +
                              std::to_string(known.size()) + " of them known");
        return predict({.needs = of.needs(),
                        .issued = issued_by_subgroup(of.code, *trips),
                        .subgroups = invocations / of.subgroup_size,
                        .bytes = bytes},
                       machine)
            .ms();
    }

    double fused_ms(double instances, const Machine& machine) const {
        const Executable& of = kernel("fused, two clips");
        const auto trips = trips_of(of.code, plan_->loops, of.subgroup_size);
        if (!trips || instances == 0) return 0;
        return predict({.needs = of.needs(),
                        .issued = issued_by_subgroup(of.code, *trips),
                        .subgroups = std::max(1.0, instances / plan_->scan.instances_per_workgroup) *
                                     subgroups_of(of.needs()),
                        .bytes = instances * static_cast<double>(character_.palette.size() * sizeof(Affine))},
                       machine)
            .ms();
    }

    std::shared_ptr<Gpu> gpu_;
    const Character& character_;
    std::vector<Executable> made_;
    std::optional<FusedPlan> plan_;
};

}  // namespace

std::vector<Json> predict_million(const Character& character, const SkinPool& pool, uint32_t instance_count,
                                  std::span<const ViewToPredict> views) {
    std::vector<Json> records;
    const std::string family = "navi21";  // which stands for NVIDIA's too (bench/isa/machines.h)
    try {
        const MillionKernels kernels(family, character, pool);
        for (const Machine& machine : machines()) {
            if (machine.code != family) continue;
            for (const ViewToPredict& view : views) {
                const Json stages = kernels.stages(instance_count, view.drawn, machine);
                records.push_back({{"bench", "million"},
                                   {"view", view.name},
                                   {"characters", instance_count},
                                   {"machine", machine.name},
                                   {"family", family},
                                   {"predicted_stages", stages},
                                   {"predicted_ms", stages["control"].get<double>() + stages["cull"].get<double>() +
                                                        stages["fused"].get<double>()}});
            }
        }
    } catch (const Failure& failure) {
        if (failure.error.code != ErrorCode::kNoDevice) throw;
    }
    return records;
}

}  // namespace throng::bench
