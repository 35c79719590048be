// What the update_rate stage reads. Shared by C++ and GLSL.
#ifndef THRONG_UPDATE_RATE_IO_H
#define THRONG_UPDATE_RATE_IO_H
#include "cull/cull_io.h"
THRONG_IO_BEGIN

THRONG_IO_CONSTANT kUpdateRateWorkgroupSize = 64;

struct UpdateRatePush {
    uint section;  // of the work (cull/cull_io.h)
    uint palette_count;
    uint unused0, unused1;
    uvec4 entry_counts;  // for each of the kLodCount sets of joints: how many of the entries belong to it
};

THRONG_IO_END
#endif
