// Skeletons from a seed, the same on every machine: what the benchmark animates.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

namespace throng::bench {

enum class SkeletonShape {
    kRandom,  // one chain down to the last level, the rest in chains of random length from random joints
    kChain,   // one joint below the other
    kComb,    // a spine of every second joint, a tooth on each
    kBinary,  // two children each, level after level
};
inline constexpr std::array kSkeletonShapes{SkeletonShape::kRandom, SkeletonShape::kChain, SkeletonShape::kComb,
                                            SkeletonShape::kBinary};
constexpr std::string_view name_of(SkeletonShape shape) {
    return std::array{"random", "chain", "comb", "binary"}[static_cast<size_t>(shape)];
}

// parents[joint_count], numbered depth first with the largest subtree of siblings last, as throng numbers a rig's
// joints. A random skeleton has exactly `level_count` levels; the other shapes' levels follow from the joint count.
// Throws kInvalidArgument if there is no such skeleton.
std::vector<uint32_t> make_skeleton(SkeletonShape shape, uint32_t joint_count, uint32_t level_count, uint64_t seed);

}  // namespace throng::bench
