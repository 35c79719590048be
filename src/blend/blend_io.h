// What the blend stage reads and writes. Shared by C++ and GLSL.
#ifndef THRONG_BLEND_IO_H
#define THRONG_BLEND_IO_H
#include "sample/sample_io.h"
THRONG_IO_BEGIN

THRONG_IO_CONSTANT kBlendWorkgroupSize = 64;

struct BlendPush {
    uint joint_count;
};

THRONG_IO_END
#endif
