// Whether scales commute with rotations.
#pragma once

#include <throng/character.h>

namespace throng {

// Whether every scale is the same along x, y and z in the rest pose and in all clips; then those of blends are too. All
// positions must lie in their arrays. False for a crafted character whose tracks share rows, which would take for ever
// to check.
bool has_uniform_scale(const Character& character);

}  // namespace throng
