// What reference_pose() (two clips) and ReferenceCharacter (layers) share: scan and bind.
#pragma once

#include <throng/reference.h>

namespace throng {

// Throws kInvalidArgument for a character that was never loaded or compiled.
void check_has_joints(const Character& character);

// parent_from_joint[joint_count], rotation, translation and scale.
ReferencePose pose_from_local(const Character& character, std::span<const Trs<double>> parent_from_joint);

}  // namespace throng
