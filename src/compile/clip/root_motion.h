// Root motion: a joint's movement over the ground is taken out of the clips, so that the instance moves instead.
#pragma once

#include "base/progress.h"
#include "compile/clip/exact_clip.h"

#include <string_view>

namespace throng {

// Takes the joint's movement over the ground out of each clip that has one, and stores it as rows of root motion
// (ExactClip::root_rows). The joint's keys become what is left: parent_from_joint' = parent_from_model * inverse(place)
// * model_from_joint. Then the joint stays above its place at the clip's start, and does not turn about +y. The turn is
// the twist about +y of the joint's rotation relative to that at the clip's start (P. Dobrowolski, Swing-twist
// decomposition in Clifford algebra, 2015).
//
// Adds rows, for other animated tracks too, where the new keys would otherwise miss what is left by more than 1e-4 of
// the character's size, or 1e-4 radians.
//
// The character's rig and size must be set; warnings are added to it. Throws kInvalidArgument if no joint has the name,
// kUnsupported if a joint above it is animated, or is not scaled the same along x, y and z, and kLimit if rows or keys
// exceed 256 MiB.
void extract_root_motion(std::vector<ExactClip>& clips, std::string_view joint_name, Character& character,
                         const Progress& progress);

}  // namespace throng
