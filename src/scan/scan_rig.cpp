#include "scan/scan_rig.h"

#include <algorithm>

namespace throng {

ScanRig::ScanRig(std::span<const uint32_t> parents_in, bool uniform_scale_in)
    : parents(parents_in.begin(), parents_in.end()), has_child(parents.size()), uniform_scale(uniform_scale_in) {
    double depth_sum = 0;
    for (const uint32_t parent : parents) {
        const uint32_t depth = parent == kNone ? 1 : depths[parent] + 1;
        if (parent != kNone) has_child[parent] = true;
        depths.push_back(depth);
        depth_sum += depth;
        level_count = std::max(level_count, depth);
    }
    mean_depth = parents.empty() ? 0 : depth_sum / static_cast<double>(parents.size());
    leaf_count = static_cast<uint32_t>(std::count(has_child.begin(), has_child.end(), false));
}

std::vector<uint32_t> ScanRig::chain(uint32_t joint) const {
    std::vector<uint32_t> joints;
    for (; joint != kNone; joint = parents[joint]) joints.push_back(joint);
    std::reverse(joints.begin(), joints.end());
    return joints;
}

}  // namespace throng
