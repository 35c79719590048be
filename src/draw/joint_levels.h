// The levels of joints, by which the lines of skeletons are coloured.
#pragma once

#include "draw/draw_io.h"

#include <throng/asset.h>

#include <vector>

namespace throng {

inline std::vector<io::JointLevel> levels_of(const std::vector<uint32_t>& parents) {
    std::vector<io::JointLevel> levels;
    for (const uint32_t parent : parents) levels.push_back({parent, parent == kNone ? 0 : levels[parent].level + 1});
    return levels;
}

}  // namespace throng
