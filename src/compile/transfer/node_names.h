// Nodes of two files that are the same by their names.
#pragma once

#include <throng/asset.h>

#include <cstdint>
#include <vector>

namespace throng {

// [node of `to`] The node of `from` that has its name, or kNone. Joints and what is animated come first. One node moves
// all that have its name, as where clothes have a skeleton of their own; of several with one name each moves one.
std::vector<uint32_t> find_sources(const Asset& from, const std::vector<bool>& is_animated, const Asset& to,
                                   const std::vector<bool>& is_joint);

}  // namespace throng
