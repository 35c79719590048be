// Source tracks -> rows of keys over one time axis.
#pragma once

#include "compile/rig/rig.h"

namespace throng {

// Appends all clips of the asset, and the rest pose, to the character: clips, times_s, keys and tracks. character.rig
// and character.size are set. Throws kLimit where the keys of all clips would exceed 256 MiB.
void compile_clips(const Asset& asset, const RigMap& map, Character& character);

}  // namespace throng
