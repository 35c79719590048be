#include "bench/skeletons.h"

#include "base/failure.h"
#include "tools/creatures/creature_math.h"

#include <throng/asset.h>

#include <algorithm>

namespace throng::bench {
namespace {

constexpr uint32_t kJointLimit = 65'535;

uint32_t below(creature::Random& random, size_t end) {
    return static_cast<uint32_t>(random.unit() * static_cast<double>(end));
}

std::vector<uint32_t> random_parents(uint32_t joint_count, uint32_t level_count, uint64_t seed) {
    creature::Random random(seed);
    std::vector<uint32_t> parents, depths, inner;  // inner: joints that may have children
    const auto add = [&](uint32_t parent) {
        const auto joint = static_cast<uint32_t>(parents.size());
        parents.push_back(parent);
        depths.push_back(parent == kNone ? 1 : depths[parent] + 1);
        if (depths.back() < level_count) inner.push_back(joint);
        return joint;
    };
    uint32_t last = add(kNone);
    while (depths[last] < level_count) last = add(last);
    while (parents.size() < joint_count) {
        last = inner[below(random, inner.size())];
        const uint32_t length = 1 + below(random, level_count - depths[last]);
        for (uint32_t i = 0; i < length && parents.size() < joint_count; ++i) last = add(last);
    }
    return parents;
}

std::vector<uint32_t> regular_parents(SkeletonShape shape, uint32_t joint_count) {
    std::vector<uint32_t> parents{kNone};
    for (uint32_t joint = 1; joint < joint_count; ++joint)
        parents.push_back(shape == SkeletonShape::kBinary                   ? (joint - 1) / 2
                          : shape == SkeletonShape::kComb && joint % 2 == 0 ? joint - 2
                                                                            : joint - 1);
    return parents;
}

// Depth first, the sibling with the largest subtree last: a walk in this order keeps few parents waiting.
std::vector<uint32_t> in_depth_first_order(const std::vector<uint32_t>& parents) {
    const auto count = static_cast<uint32_t>(parents.size());
    std::vector<uint32_t> sizes(count, 1);
    std::vector<std::vector<uint32_t>> children(count);
    for (uint32_t joint = count; joint-- > 1;) {
        sizes[parents[joint]] += sizes[joint];
        children[parents[joint]].push_back(joint);
    }
    struct Visit {
        uint32_t joint, new_parent;
    };
    std::vector<uint32_t> ordered;
    std::vector<Visit> stack{{0, kNone}};
    while (!stack.empty()) {
        const Visit visit = stack.back();
        stack.pop_back();
        const auto joint = static_cast<uint32_t>(ordered.size());
        ordered.push_back(visit.new_parent);
        auto& siblings = children[visit.joint];
        std::stable_sort(siblings.begin(), siblings.end(), [&](uint32_t a, uint32_t b) { return sizes[a] > sizes[b]; });
        // The last one pushed, the smallest, comes first
        for (const uint32_t child : siblings) stack.push_back({child, joint});
    }
    return ordered;
}

}  // namespace

std::vector<uint32_t> make_skeleton(SkeletonShape shape, uint32_t joint_count, uint32_t level_count, uint64_t seed) {
    const auto refuse = [](const std::string& what) { throw Failure(ErrorCode::kInvalidArgument, "skeleton", what); };
    if (joint_count < 1 || joint_count > kJointLimit)
        refuse(std::to_string(joint_count) + " joints: 1 to " + std::to_string(kJointLimit) + " are possible");
    if (shape != SkeletonShape::kRandom) return in_depth_first_order(regular_parents(shape, joint_count));
    const uint32_t least = joint_count > 1 ? 2 : 1;  // one root
    if (level_count < least || level_count > joint_count)
        refuse(std::to_string(level_count) + " levels: a skeleton of " + std::to_string(joint_count) + " joints has " +
               std::to_string(least) + " to " + std::to_string(joint_count));
    return in_depth_first_order(random_parents(joint_count, level_count, seed));
}

}  // namespace throng::bench
