// A skeleton's tree, for the scan methods and the planner.
#pragma once

#include <throng/character.h>

#include <span>
#include <vector>

namespace throng {

struct ScanRig {
    std::vector<uint32_t> parents;  // [joint_count], parents[j] < j, or kNone
    std::vector<uint32_t> depths;   // [joint_count], number of joints on the path from the root, both ends included
    std::vector<bool> has_child;    // [joint_count]
    uint32_t level_count = 0;       // the largest depth
    uint32_t leaf_count = 0;
    double mean_depth = 0;
    bool uniform_scale = false;  // every local transform is a similarity, in every pose

    ScanRig() = default;
    explicit ScanRig(std::span<const uint32_t> parents, bool uniform_scale = false);
    // The path from the root down to the joint.
    std::vector<uint32_t> chain(uint32_t joint) const;
    uint32_t joint_count() const { return static_cast<uint32_t>(parents.size()); }
};

}  // namespace throng
