#include "scan/doubling_table.h"
#include "scan/scan_table.h"

namespace throng {
namespace {

ScanPlan plan(const ScanRig& rig, const ScanLimits& limits, uint32_t threads) {
    DoublingTable table = doubling_table(rig.parents);
    const uint32_t rounds = table.round_count;
    // GLSL has no empty arrays
    const SharedJoints shared(rounds > 1 ? rig.joint_count() : 1, limits);
    ScanPlan plan{.workgroup_size = strided_workgroup_size(rig.joint_count(), limits, threads),
                  .constants = shared.constants,
                  .on_chip = shared.fit};
    const bool reloads = rig.joint_count() > plan.workgroup_size;
    plan.constants.insert(plan.constants.end(), {reloads ? 1u : 0u, rounds});

    ScanCounter counter(plan.workgroup_size, limits.subgroup_size);
    count_doubling(table, rig.joint_count(), reloads, shared.fit, counter);
    counter.shared_bytes(shared.bytes);
    plan.counts = counter.counts();
    plan.links = std::move(table.links);
    return plan;
}

Flow simulate(const ScanRig& rig, const FlowSettings&) {
    Flow flow(rig);
    const std::vector<Product> products = flow_doubling(flow, rig.parents);
    for (uint32_t joint = 0; joint < rig.joint_count(); ++joint) flow.store(joint, joint, products[joint]);
    return flow;
}

}  // namespace

ScanMethod doubling() {
    return {.name = "doubling",
            .order = 30,
            .summary = "one thread per joint, ancestors twice as far up each round",
            .source = "Hillis and Steele, CACM 1986 (the paper's Algorithm 2)",
            .origin = ScanOrigin::kPaper,
            .thread_choices = strided_choices,
            .planned_choices = no_thread_choice,
            .plan = plan,
            .picture = {simulate, "A product covers twice as many joints after each round."},
            .rank = 60,
            .style = {{"#e0703c", "#ff9b6a"}, 1.7, "(11,4,3,4)", 10, 0.6}};
}

}  // namespace throng
