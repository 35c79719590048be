#include "bench/million_prediction.h"

#include "base/failure.h"
#include "bench/isa/compiler.h"
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

// The kernels of a crowd with a pool of skin matrices, and the times predicted for them.
class MillionKernels {
public:
    MillionKernels(const std::string& family, const Character& character, const SkinPool& pool)
        : character_(character) {
        const Compiler compiler(family, kSubgroup);
        const CrowdSettings settings{.groups = {{.character = &character, .instance_count = 1, .skin_pool = pool}},
                                     .timestamps = false};
        CrowdSettings viewed = settings;
        viewed.culling.emplace();
        made_ = compiler.made_by([&] { value_of(Crowd::create(Device(compiler.gpu()), viewed)); });
        plan_ = choose_path(*compiler.gpu(), viewed, viewed.groups[0]).fused;
    }

    // Milliseconds of each stage. Throws kUnsupported if the machine code is not what is counted here.
    Json stages(uint32_t instances, DrawnCounts drawn, const Machine& machine) const {
        const double control = control_ms(instances, machine), cull = cull_ms(instances, drawn, machine),
                     fused = fused_ms(drawn.own, machine);
        return {{"control", control}, {"cull", cull}, {"fused", fused}};
    }

private:
    // A playback is read and its times are written, which moves whole cache lines; a cursor is written.
    double control_ms(double instances, const Machine& machine) const {
        const double searched = std::bit_width(std::ranges::max(character_.clips, {}, &Clip::row_count).row_count);
        return ms_of("control", {{"rows", searched}, {"rows", searched}}, instances,
                     instances * (2 * sizeof(io::InstancePlayback) + sizeof(io::InstanceCursor)), machine);
    }

    double cull_ms(uint32_t instances, DrawnCounts drawn, const Machine& machine) const {
        constexpr double kWord = sizeof(uint32_t), kWide = io::kCullWorkgroupSize, kFours = io::kCounters / 4;
        constexpr double kRanks = std::bit_width(io::kCullWorkgroupSize) - 1;
        const double workgroups = cull_workgroups_of(instances), cells = cells_of_workgroup(instances),
                     share = std::ceil(workgroups / kWide), all = instances, seen = drawn.own + drawn.shared,
                     invocations = workgroups * kWide, in_seen_cells = std::min(all, kWide * drawn.cells);
        const double seen_of_workgroup = std::ceil(cells * in_seen_cells / all);
        // What the kernel reads and writes: the boxes of all cells; placements and states of instances in cells that
        // are seen; states and verdicts of all instances; cursors and rows of those that are drawn
        const double culled_bytes = sizeof(io::Cell) * std::ceil(all / kWide) +
                                    in_seen_cells * (sizeof(Affine) + kWord) + all * 2 * kWord +
                                    seen * (sizeof(io::InstanceCursor) + kWord);
        // Trips as in LoopTrips: those of inner loops are summed over all entries
        const std::vector<LoopTrips> of_offsets{{"counters", kFours},
                                                {"workgroups", kFours * share},
                                                {"invocations", io::kCullWorkgroupSize},
                                                {"counters", io::kCounters},
                                                {"counters", kFours},
                                                {"invocations", kFours * io::kCullWorkgroupSize},
                                                {"workgroups", kFours * share},
                                                {"sections", 1}};
        return ms_of("cull", {{"cells", std::max(seen_of_workgroup, 1.0)}}, invocations, culled_bytes, machine) +
               ms_of("offsets", of_offsets, kWide, 2.0 * static_cast<double>(workgroups) * io::kCounters * kWord,
                     machine) +
               ms_of("list", {{"cells", cells}, {"ranks", cells * kRanks}}, invocations,
                     all * kWord + seen * kWord + drawn.own * 2 * kWord, machine);
    }

    double fused_ms(double instances, const Machine& machine) const {
        if (!plan_)
            throw Failure(ErrorCode::kUnsupported, "prediction",
                          "only fused updates are predicted, and the character is updated stage by stage");
        if (instances == 0) return 0;
        const double workgroups = std::max(1.0, instances / plan_->scan.instances_per_workgroup);
        return ms_of("fused, two clips", plan_->loops, workgroups * plan_->scan.workgroup_size,
                     instances * static_cast<double>(character_.palette.size() * sizeof(Affine)), machine);
    }

    double ms_of(std::string_view name, const std::vector<LoopTrips>& loops, double invocations, double bytes,
                 const Machine& machine) const {
        const auto kernel = std::ranges::find(made_, name, &Executable::name);
        if (kernel == made_.end())
            throw Failure(ErrorCode::kUnsupported, "prediction", "kernel '" + std::string(name) + "' was not compiled");
        const auto trips = trips_of(kernel->code, loops, kernel->subgroup_size);
        if (!trips)
            throw Failure(
                ErrorCode::kUnsupported, "prediction",
                "the loops of kernel '" + std::string(name) + "' do not match those that the prediction counts");
        return predict({.needs = kernel->needs(),
                        .issued = issued_by_subgroup(kernel->code, *trips),
                        .subgroups = invocations / kernel->subgroup_size,
                        .bytes = bytes},
                       machine)
            .ms();
    }

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
                                   {"subgroup_size", kSubgroup},
                                   {"predicted_stages", stages},
                                   {"predicted_ms", stages["control"].get<double>() + stages["cull"].get<double>() +
                                                        stages["fused"].get<double>()}});
            }
        }
    } catch (const Failure& failure) {
        if (failure.error.code == ErrorCode::kNoDevice) return {};
        return {{{"bench", "million"}, {"family", family}, {"unsupported_reason", failure.error.text()}}};
    }
    return records;
}

}  // namespace throng::bench
