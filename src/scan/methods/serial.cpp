#include "scan/scan_table.h"

namespace throng {
namespace {

// A software device runs one workgroup per core at a time, so the smallest workgroups spread most evenly. A GPU needs
// two or more warps.
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
    plan.counts.scattered = plan.counts.splits_lines = true;
    const double run_count = plan.links[0];
    plan.counts.loop_iterations = rig.joint_count() + 2 * uint64_t{plan.links[0]} + 1;
    plan.counts.issue_rows = (rig.joint_count() * (rows_of_local + kRowsOfAffine) +
                              run_count * (kRowsOfAffine + 3 * kRowsOfLink)) /
                             limits.subgroup_size;
    plan.counts.loops = {{"runs", run_count}, {"joints", static_cast<double>(rig.joint_count())}};
    return plan;
}

ScanPlan plan_affine(const ScanRig& rig, const ScanLimits& limits, uint32_t) {
    return plan_with(rig, limits, kRowsOfAffine);
}
ScanPlan plan_similarity(const ScanRig& rig, const ScanLimits& limits, uint32_t) {
    return plan_with(rig, limits, kRowsOfSimilarity);
}

Flow simulate(const ScanRig& rig, const FlowSettings&) {
    Flow flow(rig);
    std::vector<Product> products = local_products(rig);
    flow.phase("one thread,\njoint after joint");
    for (uint32_t joint = 0; joint < rig.joint_count(); ++joint) {
        const uint32_t parent = rig.parents[joint];
        const bool in_register = parent + 1 == joint;  // within a run of joints
        if (parent != kNone)
            products[joint] = flow.multiply(0, in_register ? FlowSource::kRegister : FlowSource::kShared,
                                            products[parent], products[joint]);
        flow.store(0, joint, products[joint]);
    }
    return flow;
}

}  // namespace

ScanMethod serial() {
    return {.name = "serial",
            .order = 70,
            .summary = "one thread per character, joints in order",
            .source = "common practice on CPUs (ozz-animation)",
            .origin = ScanOrigin::kBaseline,
            .thread_choices = no_thread_choice,
            .plan = plan_affine,
            .fused_place = [](const ScanLimits& limits,
                              const FusedNeed&) { return FusedPlace{.order = limits.is_cpu ? 10u : 0u}; },
            .picture = {simulate,
                        "One thread for the whole character; the threads beside it have characters of their own."},
            .rank = 30,
            .style = {{"#4f565e", "#b1bac4"}, 1.6, "", 7, 0.4}};
}

ScanMethod serial_quaternion() {
    return {.name = "serial_quaternion",
            .order = 80,
            .summary = "serial, from rotations, translations and uniform scales of 32 bytes",
            .source = "serial, on a smaller input",
            .format = ScanFormat::kSimilarity,
            .thread_choices = no_thread_choice,
            .plan = plan_similarity,
            .rank = 120,
            .style = {{"#7a4fd6", "#b08cff"}, 2.4, "", 13, 0.55}};
}

ScanMethod serial_transposed() {
    return {.name = "serial_transposed",
            .order = 90,
            .summary = "serial, with the same joint of all characters side by side in memory",
            .source = "structure of arrays, common practice on GPUs",
            .origin = ScanOrigin::kBaseline,
            .layout = ScanLayout::kTransposed,
            .thread_choices = no_thread_choice,
            .plan = plan_affine,
            .rank = 10,
            .style = {{"#98a0a9", "#6e7681"}, 1.6, "", 6, 0.5}};
}

}  // namespace throng
