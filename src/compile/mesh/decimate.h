// Fewer triangles for a mesh that moves.
#pragma once

#include "base/progress.h"

#include <throng/character.h>

#include <cstdint>
#include <span>
#include <vector>

namespace throng {

// Collapses edges towards one of their ends, so that the mesh that is left has only vertices that were there. The next
// edge is always the one by which the two meshes come to lie the least apart, either way, in the pose in which that is
// the most. So what moves keeps the triangles that it needs to move by, and what is flat in all poses loses its own.
// (Error control by points that have been lost: R. Klein, G. Liebich and W. Strasser, Mesh Reduction with Error
// Control, Visualization 1996.)
//
// `indices` are vertices of the character, `positions` [poses][vertices], of which the first is the rest pose. Returns
// for each number of indices, the largest first, those of a mesh with no more, or of the coarsest one that nothing
// vanishes from.
std::vector<std::vector<uint32_t>> decimate(const Character& character, std::span<const uint32_t> indices,
                                            std::span<const std::vector<Vec3<float>>> positions,
                                            std::span<const size_t> index_counts, const Progress& progress);

}  // namespace throng
