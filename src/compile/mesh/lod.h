// Coarser meshes for characters far away.
#pragma once

#include "base/progress.h"
#include "compile/mesh/posed_mesh.h"

#include <throng/character.h>

#include <cstdint>
#include <span>

namespace throng {

inline constexpr uint32_t kLodPoses = 7;  // poses of clips that levels are made in, beside the rest pose

// Fills lods, lod_ranges and lod_indices from the mesh in `poses`, of which the first must be the rest pose, adds the
// vertices that levels have moved, and measures errors in the same poses; errors are above 0. Does not use clips. A
// character gets no levels if it has at most 64 triangles, or cannot be made markedly coarser. Returns the number of
// search steps that measuring the errors took; it must not grow faster than the mesh.
uint64_t make_lods(Character& character, std::span<const MeshPose> poses, const Progress& progress = {});

}  // namespace throng
