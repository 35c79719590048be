// What the terrain stage reads and writes. Shared by C++ and GLSL.
#ifndef THRONG_TERRAIN_IO_H
#define THRONG_TERRAIN_IO_H
#include "gpu/shader_types.h"
THRONG_IO_BEGIN

THRONG_IO_CONSTANT kTerrainWorkgroupSize = 64;

struct TerrainPush {
    uint instance_count;
    uint columns, rows;  // of points, at least 1 each
    float x, z;          // of the first point, world space
    float inverse_spacing;
};

THRONG_IO_END
#endif
