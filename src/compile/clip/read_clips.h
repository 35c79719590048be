// Source tracks -> rows of keys over one time axis.
#pragma once

#include "base/progress.h"
#include "compile/clip/exact_clip.h"
#include "compile/rig/rig.h"

namespace throng {

// All clips of the asset. The character's rig and size must be set; warnings are added to it. Throws kLimit if the keys
// of all clips would exceed 256 MiB.
std::vector<ExactClip> read_clips(const Asset& asset, const RigMap& map, Character& character,
                                  const Progress& progress = {});

}  // namespace throng
