// The definition of the sample stage.
#pragma once

#include "control/control_reference.h"

namespace throng {

// The shortest arc between unit quaternions.
Quaternion<double> slerp_reference(Quaternion<double> a, Quaternion<double> b, double w);

// parent_from_joint of every joint; clip == clip count is the rest pose.
std::vector<Trs<double>> sample_reference(const Character& character, uint32_t clip, double local_time_s);

}  // namespace throng
