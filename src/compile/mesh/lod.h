// Coarser meshes for characters far away.
#pragma once

#include "base/progress.h"

#include <throng/character.h>

#include <cstdint>

namespace throng {

// Fills lods, lod_ranges and lod_indices from the mesh in its rest pose, and measures errors in that and in
// poses of clips; they are above 0. A character of no more than 64 triangles has none, nor one that cannot be made
// markedly coarser. Returns how many boxes and triangles were looked at to measure the errors, which must not grow
// faster than the mesh.
uint64_t make_lods(Character& character, const Progress& progress = {});

}  // namespace throng
