// Coarser meshes for characters far away.
#pragma once

#include "base/progress.h"

#include <throng/character.h>

#include <cstdint>

namespace throng {

// Fills lods, lod_ranges and lod_indices from the mesh in its rest pose and in poses of clips, adds the vertices that
// levels have moved, and measures errors in the same poses; errors are above 0. A character gets no levels if it has at
// most 64 triangles, or cannot be made markedly coarser. Returns the number of search steps that measuring the errors
// took; it must not grow faster than the mesh.
uint64_t make_lods(Character& character, const Progress& progress = {});

}  // namespace throng
