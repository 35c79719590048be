// Spherical interpolation of rotations.
#pragma once

#include <throng/transform.h>

namespace throng {

// The shortest arc between unit quaternions.
Quaternion<double> slerp(Quaternion<double> a, Quaternion<double> b, double w);

}  // namespace throng
