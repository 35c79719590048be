// Counts of what a view has listed.
#pragma once

#include <throng/crowd.h>

#include <algorithm>
#include <span>
#include <vector>

namespace throng::tools {

// Characters of each level of detail, the finest first.
inline std::vector<uint32_t> count_by_lod(std::span<const DrawnInstance> drawn) {
    std::vector<uint32_t> counts;
    for (const DrawnInstance& one : drawn) {
        counts.resize(std::max<size_t>(counts.size(), one.lod + 1));
        ++counts[one.lod];
    }
    return counts;
}

}  // namespace throng::tools
