// Whether scales commute with rotations.
#pragma once

#include <throng/character.h>

namespace throng {

// Whether every scale is the same along x, y and z in the rest pose and in all clips. Then so are those of blends. Goes
// through all rows of all scale tracks: their positions must lie in their arrays, and tracks must not share rows, which
// could take for ever in a crafted character (check_character() checks both first).
bool has_uniform_scale(const Character& character);

}  // namespace throng
