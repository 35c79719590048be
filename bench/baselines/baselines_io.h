// What the baselines' shaders read. Shared by C++ and GLSL.
#ifndef THRONG_BENCH_BASELINES_IO_H
#define THRONG_BENCH_BASELINES_IO_H
#include "sample/sample_io.h"
THRONG_IO_BEGIN

THRONG_IO_CONSTANT kBaselineWorkgroupSize = 64;

struct BaselinePush {
    uint palette_count;
};

THRONG_IO_END
#endif
