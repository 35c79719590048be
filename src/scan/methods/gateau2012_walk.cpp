#include "scan/scan_table.h"

namespace throng {
namespace {

ScanPlan plan(const ScanRig& rig, const ScanLimits& limits, uint32_t threads) {
    ScanPlan plan{.workgroup_size = strided_workgroup_size(rig.joint_count(), limits, threads),
                  .links = rig.parents,
                  .on_chip = true};
    std::vector<uint32_t> multiplications;
    for (const uint32_t depth : rig.depths) multiplications.push_back(depth - 1);
    ScanCounter counter(plan.workgroup_size, limits.subgroup_size);
    counter.loops("joints", "ancestors", counter.phase(multiplications, 2));
    plan.counts = counter.counts();
    return plan;
}

Flow simulate(const ScanRig& rig, const FlowSettings&) {
    Flow flow(rig);
    flow.phase("each joint walks\nup to the root");
    for (uint32_t joint = 0; joint < rig.joint_count(); ++joint) {
        Product product{joint};
        for (uint32_t ancestor = rig.parents[joint]; ancestor != kNone; ancestor = rig.parents[ancestor])
            product = flow.multiply(joint, FlowSource::kLocal, {ancestor}, product);
        flow.store(joint, joint, product);
    }
    return flow;
}

}  // namespace

ScanMethod gateau2012_walk() {
    return {.name = "gateau2012_walk",
            .order = 10,
            .summary = "one thread per joint walks up to the root",
            .source = "Gateau, Massive Crowds on GPU, GTC 2012 (the paper's Algorithm 1)",
            .origin = ScanOrigin::kPaper,
            .thread_choices = strided_choices,
            .planned_choices = no_thread_choice,
            .plan = plan,
            .picture = {simulate, "Every joint multiplies the whole chain above it again."},
            .rank = 40,
            .style = {{"#d29922", "#f2cc60"}, 1.8, "(3,4)", 8, 0.6}};
}

}  // namespace throng
