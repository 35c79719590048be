// Fewer triangles for a mesh that moves.
#pragma once

#include "base/progress.h"

#include <throng/character.h>

#include <cstdint>
#include <span>
#include <vector>

namespace throng {

// Collapses edges into one of their ends, so that the mesh that is left has only vertices of the fine one. Next is
// always the edge whose collapse brings the two meshes the least apart, measured both ways and in the pose in which
// they are furthest apart. So parts that move keep the triangles that they need for it, and what is flat in all poses
// loses its own. (Error control by points that have been lost: R. Klein, G. Liebich and W. Strasser, Mesh Reduction
// with Error Control, Visualization 1996.)
//
// `indices` are vertices of the character, `positions` [poses][vertices], the rest pose first. Returns, for each of
// `index_counts` (the largest first), the indices of a mesh with no more than that, or of the coarsest mesh from which
// no piece has vanished.
std::vector<std::vector<uint32_t>> decimate(const Character& character, std::span<const uint32_t> indices,
                                            std::span<const std::vector<Vec3<float>>> positions,
                                            std::span<const size_t> index_counts, const Progress& progress);

}  // namespace throng
