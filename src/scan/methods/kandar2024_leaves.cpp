#include "scan/scan_table.h"

#include <algorithm>

namespace throng {
namespace {

constexpr uint64_t kMaxWords = uint64_t{16} << 20;
constexpr uint32_t kLargestWorkgroup = 256;

// The number of characters that leaves the fewest lanes of the workgroup's subgroups idle.
uint32_t characters_per_workgroup(uint32_t leaf_count, uint32_t subgroup_size, uint32_t largest) {
    uint32_t best = 1;
    double best_share = 0;
    for (uint32_t characters = 1; characters * leaf_count <= largest; ++characters) {
        const uint32_t busy = characters * leaf_count,
                       threads = (busy + subgroup_size - 1) / subgroup_size * subgroup_size;
        const double share = threads <= largest ? static_cast<double>(busy) / threads : 0;
        if (share <= best_share) continue;
        best = characters;
        best_share = share;
    }
    return best;
}

ScanPlan plan(const ScanRig& rig, const ScanLimits& limits, uint32_t) {
    // A joint belongs to the first leaf below it, so the joints of a leaf are the lower end of its path.
    std::vector<uint32_t> leaves, owner(rig.joint_count(), kNone);
    uint64_t word_count = 1;
    for (uint32_t joint = 0; joint < rig.joint_count(); ++joint) {
        if (rig.has_child[joint]) continue;
        leaves.push_back(joint);
        word_count += 3 + rig.depths[joint];
    }
    if (word_count > kMaxWords)
        return {.unsupported_reason = "the paths of the rig's leaves take " + std::to_string(word_count) +
                                      " words, more than the limit of " + std::to_string(kMaxWords)};
    const auto leaf_count = static_cast<uint32_t>(leaves.size());

    ScanPlan plan{.links = {leaf_count}, .on_chip = true};
    plan.links.reserve(word_count);
    plan.links.resize(1 + 3 * leaves.size());
    std::vector<uint32_t> multiplications, moves;
    for (uint32_t leaf = 0; leaf < leaf_count; ++leaf) {
        const auto first = static_cast<uint32_t>(plan.links.size());
        uint32_t owned = 0;
        for (uint32_t joint = leaves[leaf]; joint != kNone; joint = rig.parents[joint]) {
            plan.links.push_back(joint);
            if (owner[joint] != kNone) continue;
            owner[joint] = leaf;
            ++owned;
        }
        std::reverse(plan.links.begin() + first, plan.links.end());
        const auto end = static_cast<uint32_t>(plan.links.size());
        plan.links[1 + 3 * leaf] = first;
        plan.links[2 + 3 * leaf] = end - owned;
        plan.links[3 + 3 * leaf] = end;
        multiplications.push_back(end - first - 1);
        moves.push_back(1 + owned);
    }

    const uint32_t largest = std::min(kLargestWorkgroup, limits.workgroup_size), subgroup = limits.subgroup_size;
    const uint32_t characters = characters_per_workgroup(leaf_count, subgroup, largest);
    plan.instances_per_workgroup = characters;
    plan.workgroup_size = std::min((characters * leaf_count + subgroup - 1) / subgroup * subgroup, largest);
    plan.constants = {characters};

    ScanCounter counter(plan.workgroup_size, limits.subgroup_size);
    std::vector<uint32_t> all_multiplications, all_moves;
    for (uint32_t character = 0; character < characters; ++character) {
        all_multiplications.insert(all_multiplications.end(), multiplications.begin(), multiplications.end());
        all_moves.insert(all_moves.end(), moves.begin(), moves.end());
    }
    counter.loops("leaves", "paths", counter.phase(all_multiplications, all_moves));
    plan.counts = counter.counts();
    plan.counts.multiplications /= characters;
    plan.counts.issue_steps /= characters;
    plan.counts.issue_rows /= characters;
    plan.counts.splits_lines = true;
    return plan;
}

Flow simulate(const ScanRig& rig, const FlowSettings&) {
    std::vector<bool> owned(rig.joint_count());
    Flow flow(rig);
    flow.phase("each leaf comes\ndown from the root");
    uint32_t thread = 0;
    for (uint32_t leaf = 0; leaf < rig.joint_count(); ++leaf) {
        if (rig.has_child[leaf]) continue;
        Product product;
        for (const uint32_t joint : rig.chain(leaf)) {
            product = product.empty() ? Product{joint} : flow.multiply(thread, FlowSource::kRegister, product, {joint});
            if (owned[joint]) continue;
            owned[joint] = true;
            flow.store(thread, joint, product);
        }
        ++thread;
    }
    return flow;
}

}  // namespace

ScanMethod kandar2024_leaves() {
    return {.name = "kandar2024_leaves",
            .order = 20,
            .summary = "one thread per leaf walks down from the root",
            .source = "Kandar 2024, as the paper describes it",
            .origin = ScanOrigin::kPaper,
            .thread_choices = no_thread_choice,
            .plan = plan,
            .picture = {simulate,
                        "Stacked: threads that make the same product at the same time. The outlined one stores it:\na "
                        "joint belongs to the first leaf below it."},
            .rank = 50,
            .style = {{"#c4761a", "#ffb757"}, 1.8, "(11,4)", 5, 0.45}};
}

}  // namespace throng
