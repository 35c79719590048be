#include "scan/doubling_table.h"
#include "scan/scan_table.h"

namespace throng {
namespace {

constexpr uint32_t kBlock = 64;

ScanPlan plan(const ScanRig& rig, const ScanLimits& limits, uint32_t) {
    const uint32_t joint_count = rig.joint_count();
    const bool fits = uint64_t{joint_count} * kDoublingBytesPerJoint <= limits.shared_memory_bytes;
    ScanPlan plan{.workgroup_size = strided_workgroup_size(joint_count, limits), .on_chip = fits};
    const bool reloads = joint_count > plan.workgroup_size;

    // The parent within the block; the first ancestor outside it; blocks crossed
    std::vector<uint32_t> inside, outside, hops;
    for (uint32_t joint = 0; joint < joint_count; ++joint) {
        const uint32_t parent = rig.parents[joint];
        const bool stays = parent != kNone && parent / kBlock == joint / kBlock;
        inside.push_back(stays ? parent : kNone);
        outside.push_back(stays ? outside[parent] : parent);
        hops.push_back(outside.back() == kNone ? 0 : hops[outside.back()] + 1);
    }
    DoublingTable table = doubling_table(inside);
    plan.constants = {fits ? joint_count : 1u, fits ? 1u : 0u, reloads ? 1u : 0u, table.round_count};

    ScanCounter counter(plan.workgroup_size, limits.subgroup_size);
    for (uint32_t round = 0; round < table.round_count; ++round) {
        count_doubling_round(table, round, joint_count, reloads, false, counter);
        counter.barrier();
    }
    counter.phase(hops, reloads ? 2 : 1);
    counter.shared_bytes(fits ? uint64_t{joint_count} * kDoublingBytesPerJoint : 0);
    plan.counts = counter.counts();
    plan.links = std::move(table.links);
    plan.links.insert(plan.links.end(), outside.begin(), outside.end());
    return plan;
}

}  // namespace

ScanMethod blocks64() {
    return {.name = "blocks64",
            .order = 40,
            .summary = "blocks of 64 joints, doubling inside a block, then hops between blocks",
            .source = "the paper's Algorithm 3",
            .origin = ScanOrigin::kPaper,
            .thread_choices = no_thread_choice,
            .plan = plan};
}

}  // namespace throng
