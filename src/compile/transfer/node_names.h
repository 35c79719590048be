// Matches the nodes of two files by their names.
#pragma once

#include <throng/asset.h>

#include <cstdint>
#include <vector>

namespace throng {

// [node of `to`]: the node of `from` with the same name, or kNone. Joints and animated nodes come first. A node that is
// alone with its name moves all joints of that name, as when clothes have a skeleton of their own; if several have one
// name, each moves one.
std::vector<uint32_t> find_sources(const Asset& from, const std::vector<bool>& is_animated, const Asset& to,
                                   const std::vector<bool>& is_joint);

}  // namespace throng
