// Puts levels of detail into a character.
#pragma once

#include "compile/mesh/fit_vertices.h"

#include <throng/character.h>

#include <span>

namespace throng {

// Fills lods, lod_ranges and lod_indices. Vertices that a level has moved become vertices of their own, behind the
// others of their section. `levels` are of this character: the finest first.
void write_levels(std::span<const FittedLevel> levels, Character& character);

}  // namespace throng
