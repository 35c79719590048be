// What the draw's shaders read beside the buffers of a crowd. Shared by C++ and GLSL.
#ifndef THRONG_DRAW_IO_H
#define THRONG_DRAW_IO_H
#include "gpu/shader_types.h"
THRONG_IO_BEGIN

// One for the whole picture. World space; std140 and std430 agree on it.
struct DrawScene {
    vec4 clip_from_world[4];  // rows
    vec4 eye;
    vec4 forward;             // the ray through a point (x, y) of the picture, each -1..1, y downward, is
    vec4 right;               // forward + x * right + y * down
    vec4 down;
    vec4 to_light;            // unit
    vec4 ground;              // centre x, height, centre z; w: radius at which it has faded into the horizon
    vec4 scale;               // x: cell of the grid, y: distance of the haze, z: height of the contact darkening
    vec4 light;               // x: exposure, y: 1 with haze, 0 without
};

// A section of a mesh, for all instances of a batch.
struct DrawPush {
    uint first_vertex;
    uint first_influences;
    uint influence_sets;
    uint palette_count;
    vec4 base_color;
    float alpha_cutoff;  // fragments below it are left out, in the pipeline that discards
    uint double_sided;
    uint first_morph, morph_count;  // of the section; count 0: none
    uint detail;                    // the level of detail that is drawn, where instances are listed
};

THRONG_IO_END
#endif
