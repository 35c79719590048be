// State of inertial transitions, per joint. Shared by C++ and GLSL.
#ifndef THRONG_INERTIA_IO_H
#define THRONG_INERTIA_IO_H
#include "sample/sample_io.h"
THRONG_IO_BEGIN

// Each vector: xyz is the offset when the transition began; w is the rate at which its length changes, per second, at
// most 0.
struct InertiaJoint {
    vec4 rotation;  // axis times angle, radians
    vec4 translation;
    vec4 scale;
};

// A joint of an instance with inertial transitions, from update to update.
struct InertiaState {
    JointPose shown, shown_before;  // in the last two updates
    InertiaJoint offset;            // when the last inertial transition began
};

THRONG_IO_END
#endif
