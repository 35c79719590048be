// Joint masks by name -> a weight for each joint of a rig.
#pragma once

#include <throng/controller.h>

#include <vector>

namespace throng {

// [joint_count], 0..1. Names that the rig does not have are passed over (check_controller() refuses them).
std::vector<float> mask_weights(const JointMask& mask, const Rig& rig);

}  // namespace throng
