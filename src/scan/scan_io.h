// What every scan method reads and writes. Shared by C++ and GLSL.
#ifndef THRONG_SCAN_IO_H
#define THRONG_SCAN_IO_H
#include "gpu/shader_types.h"
THRONG_IO_BEGIN

struct ScanPush {
    uint joint_count;
    uint instance_count;
    uint repeat_count;  // of the on-chip variant
};

THRONG_IO_END
#endif
