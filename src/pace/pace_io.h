// What the pace stage reads. Shared by C++ and GLSL.
#ifndef THRONG_PACE_IO_H
#define THRONG_PACE_IO_H
#include "gpu/shader_types.h"
THRONG_IO_BEGIN

THRONG_IO_CONSTANT kPaceWorkgroupSize = 64;

struct PacePush {
    uint section;    // of the work (cull/cull_io.h)
    uint row_count;  // of an instance's skin matrices, as pace_rows() counts them
};

THRONG_IO_END
#endif
