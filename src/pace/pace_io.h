// What the pace stage reads. Shared by C++ and GLSL.
#ifndef THRONG_PACE_IO_H
#define THRONG_PACE_IO_H
#include "cull/cull_io.h"
THRONG_IO_BEGIN

THRONG_IO_CONSTANT kPaceWorkgroupSize = 64;

struct PacePush {
    uint section;  // of the work (cull/cull_io.h)
    uint palette_count;
    uint unused0, unused1;
    uvec4 entry_counts;  // of each of the kDetailLevels sets of joints: how many of the entries are its
};

THRONG_IO_END
#endif
