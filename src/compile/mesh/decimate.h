// Fewer triangles for a mesh that moves.
#pragma once

#include "base/progress.h"
#include "compile/mesh/triangle_index.h"
#include "compile/mesh/welded_mesh.h"

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace throng {

// Collapses each edge into one of its ends, so the result uses only vertices of the fine mesh. The next edge is always
// the one whose collapse adds the least distance between the two meshes, measured in both directions and in the pose in
// which they are furthest apart. So parts that bend keep the triangles that they need, and parts that are flat in all
// poses lose theirs. (The error is measured at the points that were removed, after R. Klein, G. Liebich and W.
// Strasser, Mesh Reduction with Error Control, Visualization 1996.)
//
// `fine_surface` holds the triangles of `fine` at rest. For each of `index_counts` (the largest first), `take` gets a
// mesh with at most that many indices, or the coarsest mesh from which no piece has vanished; it returns false if it
// needs no more.
void decimate(const WeldedMesh& fine, const TriangleIndex& fine_surface, std::span<const size_t> index_counts,
              const std::function<bool(std::vector<uint32_t>)>& take, const Progress& progress);

}  // namespace throng
