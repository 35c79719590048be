// Parameters and data of the layered stage. Shared by C++ and GLSL.
#ifndef THRONG_LAYERED_IO_H
#define THRONG_LAYERED_IO_H
#include "gpu/shader_types.h"
THRONG_IO_BEGIN

THRONG_IO_CONSTANT kLayeredWorkgroupSize = 64;

struct LayeredPush {
    uint joint_count;
    uint active_clip_limit;  // active clips kept for each instance
};

// For the joints first_joint to joint_end - 1.
struct LayeredInOrderPush {
    uint instance_count;
    uint joint_count;
    uint active_clip_limit;
    uint first_joint, joint_end;
};

// Rotations of a joint's model_from_joint, as unit quaternions, for a layer that blends in model space: of the layers
// below, of the layer alone, and of both blended.
struct ModelRotations {
    vec4 below, layer, blended;
};

THRONG_IO_END
#endif
