// Poses that the application set. Shared by C++ and GLSL.
#ifndef THRONG_POSE_OVERRIDE_IO_H
#define THRONG_POSE_OVERRIDE_IO_H
#include "gpu/shader_types.h"
THRONG_IO_BEGIN

// An instance's pose override, read as words of a table.
struct InstancePose {
    uint slot;     // its pose is poses[slot][joint]; meaningless if the weight is 0
    float weight;  // 0: the animated pose, 1: the set pose
};

THRONG_IO_END
#endif
