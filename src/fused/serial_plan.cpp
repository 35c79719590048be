#include "fused/serial_plan.h"

#include "fused/fused_io.h"
#include "scan/pieces.h"
#include "scan/pieces_io.h"

namespace throng {
namespace {

struct Segment {
    uint32_t fixed = 0, free = 0;  // numbers of steps of the walk
};

std::vector<Segment> segments_of(std::span<const uint32_t> walk, const std::vector<bool>& fixed) {
    std::vector<Segment> segments{{}};
    for (const uint32_t step : walk) {
        const bool is_fixed = fixed[step & io::kWalkJointMask];
        if (is_fixed && segments.back().free > 0) segments.emplace_back();
        ++(is_fixed ? segments.back().fixed : segments.back().free);
    }
    // A software device runs each loop one iteration more than needed, so if fixed and free steps alternate often, it
    // is faster to treat all steps as free.
    constexpr double kFixedCost = 0.6;  // relative to a free step
    double cost = 0;
    for (const Segment& segment : segments) cost += kFixedCost * (segment.fixed + 1) + segment.free + 1;
    if (cost > static_cast<double>(walk.size())) return {{.fixed = 0, .free = static_cast<uint32_t>(walk.size())}};
    return segments;
}

}  // namespace

ScanPlan plan_fused_serial(const ScanRig& rig, const std::vector<bool>& fixed, const ScanLimits& limits) {
    const PieceTable table = piece_table(rig, 1, kRowsOfAffine);
    const auto walk = std::span(table.links).subspan(io::kFirstRow + table.path_row_count + table.round_count);
    ScanPlan plan{.workgroup_size = limits.is_cpu ? limits.subgroup_size : std::min(64u, limits.workgroup_size)};
    plan.instances_per_workgroup = plan.workgroup_size;
    plan.constants = {0, std::max(table.slot_count, 1u) * plan.workgroup_size};
    const std::vector<Segment> segments = segments_of(walk, fixed);
    plan.links.push_back(static_cast<uint32_t>(segments.size()));
    for (const Segment& segment : segments) plan.links.insert(plan.links.end(), {segment.fixed, segment.free});
    plan.links.insert(plan.links.end(), walk.begin(), walk.end());
    plan.counts.multiplications = rig.joint_count();
    plan.counts.longest_thread = rig.joint_count();
    Segment sum;
    for (const Segment& segment : segments) sum = {sum.fixed + segment.fixed, sum.free + segment.free};
    const double segment_count = static_cast<double>(segments.size()), fixed_count = sum.fixed, free_count = sum.free;
    plan.counts.loops = {{"segments", segment_count}, {"fixed joints", fixed_count}, {"free joints", free_count}};
    plan.counts.loop_iterations = rig.joint_count() + 3 * uint64_t{segments.size()} + 1;
    const uint32_t shared_bytes = limits.is_cpu ? 0 : plan.constants[1] * 48;
    plan.counts.shared_bytes = shared_bytes;
    plan.unsupported_reason = memory_unsupported_reason(shared_bytes, kForWaitingParents, limits);
    return plan;
}

}  // namespace throng
