#include "scan/scan_table.h"

#include <algorithm>

namespace throng {
namespace {

constexpr uint32_t kRadix = 4;

// For each joint, the ancestor `steps` times as far up as `ancestors`.
std::vector<uint32_t> farther(const std::vector<uint32_t>& ancestors, uint32_t steps) {
    std::vector<uint32_t> out = ancestors;
    for (uint32_t i = 1; i < steps; ++i)
        for (uint32_t& ancestor : out)
            if (ancestor != kNone) ancestor = ancestors[ancestor];
    return out;
}

ScanPlan plan(const ScanRig& rig, const ScanLimits& limits, uint32_t) {
    const uint32_t joint_count = rig.joint_count();
    uint32_t rounds = 1;
    for (uint64_t reach = kRadix; reach < rig.level_count; reach *= kRadix) ++rounds;
    // GLSL has no empty arrays
    const SharedJoints shared(rounds > 1 ? joint_count : 1, limits);
    ScanPlan plan{.workgroup_size = strided_workgroup_size(joint_count, limits),
                  .constants = shared.constants,
                  .on_chip = shared.fit};
    plan.constants.push_back(rounds);

    ScanCounter counter(plan.workgroup_size, limits.subgroup_size);
    ScanCounter::Trips trips;
    std::vector<uint32_t> ancestors = rig.parents, multiplications(joint_count);
    for (uint32_t round = 0; round < rounds; ++round) {
        if (round > 0) counter.barrier();
        plan.links.insert(plan.links.end(), ancestors.begin(), ancestors.end());
        for (uint32_t joint = 0; joint < joint_count; ++joint) {
            multiplications[joint] = 0;
            for (uint32_t at = ancestors[joint]; at != kNone && multiplications[joint] + 1 < kRadix; at = ancestors[at])
                ++multiplications[joint];
        }
        const ScanCounter::Trips of_round = counter.phase(multiplications, 2);
        trips = {trips.strides + of_round.strides, trips.multiplications + of_round.multiplications};
        ancestors = farther(ancestors, kRadix);
    }
    if (rounds > 1) counter.loop("rounds", rounds);  // compilers remove a loop that runs once
    counter.loops("joints", "ancestors", trips);
    counter.shared_bytes(shared.bytes);
    plan.counts = counter.counts();
    return plan;
}

}  // namespace

ScanMethod doubling4() {
    return {.name = "doubling4",
            .order = 130,
            .summary = "doubling, with three ancestors a round: half as many barriers",
            .source = "doubling; higher-radix scans (Merrill and Grimshaw 2009)",
            .thread_choices = no_thread_choice,
            .plan = plan};
}

}  // namespace throng
