// What the fused kernel reads and writes beside its stages' own. Shared by C++ and GLSL.
#ifndef THRONG_FUSED_IO_H
#define THRONG_FUSED_IO_H
#include "gpu/shader_types.h"
THRONG_IO_BEGIN

struct FusedPush {
    uint joint_count;
    uint instance_count;
    uint palette_count;
};

THRONG_IO_END
#endif
