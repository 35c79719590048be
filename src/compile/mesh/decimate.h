// Fewer triangles for a mesh that moves.
#pragma once

#include "base/progress.h"

#include <throng/character.h>

#include <cstdint>
#include <span>
#include <vector>

namespace throng {

// Collapses each edge into one of its ends, so the result uses only vertices of the fine mesh. The next edge is always
// the one whose collapse adds the least distance between the two meshes, measured in both directions and in the pose in
// which they are furthest apart. So parts that bend keep the triangles that they need, and parts that are flat in all
// poses lose theirs. (The error is measured at the points that were removed, after R. Klein, G. Liebich and W.
// Strasser, Mesh Reduction with Error Control, Visualization 1996.)
//
// `indices` are vertices of the character, `positions` [poses][vertices], the rest pose first. Returns, for each of
// `index_counts` (the largest first), a mesh with at most that many indices, or the coarsest mesh from which no piece
// has vanished.
std::vector<std::vector<uint32_t>> decimate(const Character& character, std::span<const uint32_t> indices,
                                            std::span<const std::vector<Vec3<float>>> positions,
                                            std::span<const size_t> index_counts, const Progress& progress);

}  // namespace throng
