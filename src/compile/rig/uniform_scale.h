// Whether scales commute with rotations.
#pragma once

#include <throng/character.h>

namespace throng {

// Whether every scale is the same along x, y and z in the rest pose and in all clips; blends of such are too. All
// positions must lie in their arrays. A crafted character whose tracks share rows, which would take for ever, has none.
bool has_uniform_scale(const Character& character);

}  // namespace throng
