// Puts levels of detail into a character.
#pragma once

#include "compile/mesh/coarse_mesh.h"

#include <throng/character.h>

#include <span>

namespace throng {

struct MeasuredLevel {
    const CoarseMesh* mesh = nullptr;
    float error = 0;  // model space
};

// Fills lods, lod_ranges and lod_indices. Vertices that a level has moved become vertices of their own, behind the
// others of their section. `levels` are of this character: the finest first.
void write_levels(std::span<const MeasuredLevel> levels, Character& character);

}  // namespace throng
