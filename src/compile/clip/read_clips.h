// Source tracks -> rows of keys over one time axis.
#pragma once

#include "base/progress.h"
#include "compile/clip/exact_clip.h"
#include "compile/rig/rig.h"

namespace throng {

// All clips of the asset. Of the character, rig and size are set; warnings are added to it. Throws kLimit where the
// keys of all clips would exceed 256 MiB.
std::vector<ExactClip> read_clips(const Asset& asset, const RigMap& map, Character& character,
                                  const Progress& progress = {});

}  // namespace throng
