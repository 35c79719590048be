// Hierarchical spatial hashing over the ground: one grid of cells for each size class of agents; all grids share the
// buckets of one hash table. Sources: M. Teschner et al., Optimized Spatial Hashing for Collision Detection of
// Deformable Objects, VMV 2003; a grid for each size: C. Ericson, Real-Time Collision Detection, 2005, 7.2.1.
#ifndef THRONG_STEER_GRID_GLSL
#define THRONG_STEER_GRID_GLSL
#include "steer/steer_io.h"

ivec2 cell_of(vec2 place, float inverse_cell) {
    const float most = 1e9;  // places beyond share the outermost cells
    return ivec2(clamp(floor(place * inverse_cell), vec2(-most), vec2(most)));
}

uint bucket_of(uint grid, ivec2 cell, uint bucket_mask) {
    const uint mixed = uint(cell.x) * 73856093u ^ uint(cell.y) * 19349663u ^ grid * 83492791u;
    return (mixed ^ mixed >> 15) & bucket_mask;
}

#endif
