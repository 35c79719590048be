// What the references of two clips and of layers share: scan and bind.
#pragma once

#include <throng/reference.h>

namespace throng {

// parent_from_joint[joint_count], rotation, translation and scale.
ReferencePose pose_from_local(const Character& character, std::span<const Trs<double>> parent_from_joint);

}  // namespace throng
