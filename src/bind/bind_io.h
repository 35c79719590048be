// What the bind stage reads. Shared by C++ and GLSL.
#ifndef THRONG_BIND_IO_H
#define THRONG_BIND_IO_H
#include "gpu/shader_types.h"
THRONG_IO_BEGIN

THRONG_IO_CONSTANT kBindWorkgroupSize = 64;

// throng::SkinFormat
THRONG_IO_CONSTANT kSkinAffine = 0;
THRONG_IO_CONSTANT kSkinHalfAffine = 1;
THRONG_IO_CONSTANT kSkinSimilarity = 2;

struct BindPush {
    uint joint_count;
    uint palette_count;
};

THRONG_IO_END
#endif
