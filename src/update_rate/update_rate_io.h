// What the update_rate stage reads. Shared by C++ and GLSL.
#ifndef THRONG_UPDATE_RATE_IO_H
#define THRONG_UPDATE_RATE_IO_H
#include "cull/cull_io.h"
THRONG_IO_BEGIN

THRONG_IO_CONSTANT kUpdateRateWorkgroupSize = 64;

struct UpdateRatePush {
    uint section;  // section of the work list (cull/cull_io.h)
    uint palette_count;
    uint unused0, unused1;
    uvec4 entry_counts;  // palette entries in each of the kLodCount sets of joints
};

THRONG_IO_END
#endif
