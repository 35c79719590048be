#include "scan/scan_table.h"

namespace throng {
namespace {

// A software device runs one workgroup per core at a time: the smallest ones spread evenly. A GPU wants two warps or
// more.
ScanPlan plan_with(const ScanRig& rig, const ScanLimits& limits, double rows_of_local) {
    ScanPlan plan{.workgroup_size = limits.is_cpu ? limits.subgroup_size : std::min(64u, limits.workgroup_size),
                  .links = {0}};
    plan.instances_per_workgroup = plan.workgroup_size;
    uint32_t root_count = 0;
    for (uint32_t joint = 0; joint < rig.joint_count();) {
        const uint32_t parent = rig.parents[joint];
        uint32_t end = joint + 1;
        while (end < rig.joint_count() && rig.parents[end] == end - 1) ++end;
        plan.links.insert(plan.links.end(), {joint, end, parent});
        ++plan.links[0];
        root_count += parent == kNone ? 1 : 0;
        joint = end;
    }
    const uint32_t multiplications = rig.joint_count() - root_count;
    plan.counts = {.multiplications = multiplications, .longest_thread = multiplications};
    plan.counts.issue_steps = static_cast<double>(rig.joint_count()) / limits.subgroup_size;
    plan.counts.scattered = true;
    const double run_count = plan.links[0];
    plan.counts.loop_iterations = rig.joint_count() + 2 * uint64_t{plan.links[0]} + 1;
    plan.counts.issue_rows = (rig.joint_count() * (rows_of_local + kRowsOfAffine) +
                              run_count * (kRowsOfAffine + 3 * kRowsOfLink)) /
                             limits.subgroup_size;
    return plan;
}

ScanPlan plan_affine(const ScanRig& rig, const ScanLimits& limits, uint32_t) {
    return plan_with(rig, limits, kRowsOfAffine);
}
ScanPlan plan_similarity(const ScanRig& rig, const ScanLimits& limits, uint32_t) {
    return plan_with(rig, limits, kRowsOfSimilarity);
}

}  // namespace

ScanMethod serial() {
    return {.name = "serial",
            .order = 70,
            .summary = "one thread per character, joints in order",
            .source = "common practice on CPUs (ozz-animation)",
            .origin = ScanOrigin::kBaseline,
            .thread_choices = no_thread_choice,
            .plan = plan_affine};
}

ScanMethod serial_quaternion() {
    ScanMethod method = serial();
    method.name = "serial_quaternion";
    method.order = 80;
    method.summary = "serial, from rotations, translations and uniform scales of 32 bytes";
    method.source = "serial, on a smaller input";
    method.origin = ScanOrigin::kOurs;
    method.format = ScanFormat::kSimilarity;
    method.plan = plan_similarity;
    return method;
}

ScanMethod serial_transposed() {
    ScanMethod method = serial();
    method.name = "serial_transposed";
    method.order = 90;
    method.summary = "serial, with the same joint of all characters side by side in memory";
    method.source = "structure of arrays, common practice on GPUs";
    method.layout = ScanLayout::kTransposed;
    return method;
}

}  // namespace throng
