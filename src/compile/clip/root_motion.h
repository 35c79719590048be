// Root motion: what a joint moves over the ground is taken out of the clips, for the instance to move by instead.
#pragma once

#include "base/progress.h"
#include "compile/clip/exact_clip.h"

#include <string_view>

namespace throng {

// For each clip in which the joint moves over the ground, rows of how it does (ExactClip::root_rows) are added, and its
// keys become what is left: parent_from_joint' = parent_from_model * inverse(place) * model_from_joint, in which the
// joint stays above where the clip begins and does not turn about +y. The turn is the twist about +y of the joint's
// rotation against that at the clip's begin (P. Dobrowolski, Swing-twist decomposition in Clifford algebra, 2015).
// Other animated tracks get rows too where the keys that are left would be followed less closely than within 1e-4 of
// the character's size, or radians. Of the character, rig and size are set; warnings are added to it. Throws
// kInvalidArgument where no joint has the name, kUnsupported where a joint above it is animated, or is not scaled the
// same along x, y and z, and kLimit where rows or keys exceed 256 MiB.
void extract_root_motion(std::vector<ExactClip>& clips, std::string_view joint_name, Character& character,
                         const Progress& progress);

}  // namespace throng
