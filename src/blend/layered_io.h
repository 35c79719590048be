// What the layered stage is told. Shared by C++ and GLSL.
#ifndef THRONG_LAYERED_IO_H
#define THRONG_LAYERED_IO_H
#include "gpu/shader_types.h"
THRONG_IO_BEGIN

THRONG_IO_CONSTANT kLayeredWorkgroupSize = 64;

struct LayeredPush {
    uint joint_count;
    uint voice_limit;  // voices kept for each instance
};

THRONG_IO_END
#endif
