#include "scan/scan_table.h"

#include <algorithm>

namespace throng {
namespace {

// The joints of each level, those with children first.
std::vector<std::vector<uint32_t>> levels_of(const ScanRig& rig) {
    std::vector<std::vector<uint32_t>> levels(rig.level_count);
    for (const bool with_children : {true, false})
        for (uint32_t joint = 0; joint < rig.joint_count(); ++joint)
            if (rig.has_child[joint] == with_children) levels[rig.depths[joint] - 1].push_back(joint);
    return levels;
}

ScanPlan plan(const ScanRig& rig, const ScanLimits& limits, uint32_t) {
    const std::vector<std::vector<uint32_t>> levels = levels_of(rig);
    std::vector<uint32_t> parent_counts, position(rig.joint_count());
    uint32_t widest = 0;
    for (const auto& level : levels) {
        for (uint32_t i = 0; i < level.size(); ++i) position[level[i]] = i;
        parent_counts.push_back(static_cast<uint32_t>(
            std::count_if(level.begin(), level.end(), [&](uint32_t joint) { return rig.has_child[joint]; })));
        widest = std::max(widest, static_cast<uint32_t>(level.size()));
    }
    // GLSL has no empty arrays
    const SharedJoints shared(std::max(std::ranges::max(parent_counts), 1u), limits);

    ScanPlan plan{.workgroup_size = strided_workgroup_size(widest, limits),
                  .constants = shared.constants,
                  .links = {rig.level_count},
                  .on_chip = shared.fit};
    uint32_t first = 0;
    for (uint32_t level = 0; level < rig.level_count; ++level) {
        plan.links.insert(plan.links.end(), {first, first + parent_counts[level]});
        first += static_cast<uint32_t>(levels[level].size());
    }
    plan.links.push_back(first);
    for (const auto& level : levels)
        for (const uint32_t joint : level) {
            const uint32_t parent = rig.parents[joint];
            plan.links.push_back(joint | (parent == kNone ? 0 : shared.fit ? position[parent] : parent) << 16);
        }

    ScanCounter counter(plan.workgroup_size, limits.subgroup_size);
    double joints = 0;
    for (uint32_t level = 0; level < rig.level_count; ++level) {
        if (level > 0) counter.barrier();
        const size_t count = levels[level].size();
        std::vector<uint32_t> moves(count, 2);
        if (shared.fit) std::fill_n(moves.begin(), parent_counts[level], 3u);
        joints += counter.phase(std::vector<uint32_t>(count, level > 0 ? 1 : 0), moves).strides;
    }
    counter.loop("levels", rig.level_count);
    counter.loop("joints", joints);
    counter.shared_bytes(shared.bytes);
    plan.counts = counter.counts();
    return plan;
}

Flow simulate(const ScanRig& rig, const FlowSettings&) {
    Flow flow(rig);
    std::vector<Product> products = local_products(rig);
    for (const std::vector<uint32_t>& level : levels_of(rig)) {
        const bool is_first = flow.phases.empty();
        flow.phase("level " + std::to_string(flow.phases.size() + 1),
                   is_first ? FlowBoundary::kNothing : FlowBoundary::kBarrier);
        for (uint32_t thread = 0; thread < level.size(); ++thread) {
            Product& product = products[level[thread]];
            if (!is_first)
                product = flow.multiply(thread, FlowSource::kShared, products[rig.parents[level[thread]]], product);
            flow.store(thread, level[thread], product);
        }
    }
    return flow;
}

}  // namespace

ScanMethod levels() {
    return {.name = "levels",
            .order = 60,
            .summary = "level after level, a barrier between two",
            .source = "common practice on GPUs",
            .origin = ScanOrigin::kBaseline,
            .thread_choices = no_thread_choice,
            .plan = plan,
            .picture = {simulate,
                        "A thread for each joint of the widest level; in the other levels some have nothing to do."},
            .rank = 20,
            .style = {{"#7f8790", "#8b949e"}, 1.6, "(3,4)", 4, 0.45}};
}

}  // namespace throng
