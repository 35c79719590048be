#include "scan/blocks.h"
#include "scan/doubling_table.h"
#include "scan/scan_table.h"

namespace throng {
namespace {

constexpr uint32_t kBlock = 64;

ScanPlan plan(const ScanRig& rig, const ScanLimits& limits, uint32_t threads) {
    const uint32_t joint_count = rig.joint_count();
    const SharedJoints shared(joint_count, limits);
    ScanPlan plan{.workgroup_size = strided_workgroup_size(joint_count, limits, threads),
                  .constants = shared.constants,
                  .on_chip = shared.fit};
    const bool reloads = joint_count > plan.workgroup_size;

    const Blocks blocks(rig, kBlock);
    DoublingTable table = doubling_table(blocks.inside);
    plan.constants.insert(plan.constants.end(), {reloads ? 1u : 0u, table.round_count});

    ScanCounter counter(plan.workgroup_size, limits.subgroup_size);
    count_doubling(table, joint_count, reloads, false, counter);
    counter.barrier();
    counter.loops("joints, hops", "hops", counter.phase(blocks.hops, reloads ? 2 : 1));
    counter.shared_bytes(shared.bytes);
    plan.counts = counter.counts();
    plan.links = std::move(table.links);
    plan.links.insert(plan.links.end(), blocks.outside.begin(), blocks.outside.end());
    return plan;
}

Flow simulate(const ScanRig& rig, const FlowSettings& settings) {
    Flow flow(rig);
    const Blocks blocks(rig, settings.block);
    flow_hops(flow, blocks, flow_doubling(flow, blocks.inside));
    return flow;
}

}  // namespace

ScanMethod blocks64() {
    return {.name = "blocks64",
            .order = 40,
            .summary = "blocks of 64 joints, doubling inside a block, then hops between blocks",
            .source = "the paper's Algorithm 3",
            .origin = ScanOrigin::kPaper,
            .thread_choices = strided_choices,
            .planned_choices = no_thread_choice,
            .plan = plan,
            .picture = {simulate, "Drawn with blocks of 8 joints; the method has blocks of 64.", true},
            .rank = 70,
            .style = {{"#b34a1f", "#ff8552"}, 1.8, "(6,3)", 12, 0.55}};
}

}  // namespace throng
