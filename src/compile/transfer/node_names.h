// Matches the nodes of two files by their names.
#pragma once

#include <throng/asset.h>

#include <cstdint>
#include <vector>

namespace throng {

// [node of `to`]: the node of `from` with the same name, or kNone. If several nodes have a name, joints and animated
// nodes are matched first. If only one node of `from` has a name, it moves all joints of that name, as when clothes
// have a skeleton of their own. If several have it, each moves one node.
std::vector<uint32_t> find_sources(const Asset& from, const std::vector<bool>& comes_first, const Asset& to,
                                   const std::vector<bool>& is_joint);

}  // namespace throng
