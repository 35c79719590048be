// What the draw's shaders read besides the buffers of a crowd. Shared by C++ and GLSL.
#ifndef THRONG_DRAW_IO_H
#define THRONG_DRAW_IO_H
#include "gpu/shader_types.h"
THRONG_IO_BEGIN

// One for the whole picture, in world space. It has the same layout in std140 and std430. Light is linear; sun and sky
// light are given as what a white diffuse surface reflects of them.
struct DrawScene {
    vec4 clip_from_world[4];  // rows
    vec4 map_from_world[3];   // rows, of the shadow map: place in it and height towards the sun, all 0..1
    vec4 eye;                 // w: exposure
    vec4 forward;             // the ray through a point (x, y) of the picture, each -1..1, y downward, is
    vec4 right;               // forward + x * right + y * down
    vec4 down;
    vec4 to_sun;   // unit
    vec4 ground;   // centre x, height, centre z; w: size of a character
    vec4 fog;      // x: at a distance of 1 / x, fog leaves 1 / e of the light
    vec4 picture;  // x, y: pixels
    // x: texels of the map, each way; y: world size of the larger side of one; z: 1 with shadows, 0 without
    vec4 shadow;
    vec4 map_grid;  // x, y: the position of the map's first texel on a fixed grid of texels, 0..65535
    vec4 sun_light;
    vec4 sky_light;        // on a surface that looks up
    vec4 bounce_light;     // on one that looks down
    vec4 horizon, zenith;  // of the sky
    vec4 ground_albedo;
};

// A section of a mesh, for all instances of a batch.
struct DrawPush {
    uint first_vertex;
    uint first_influences;
    uint influence_sets;
    uint palette_count;
    vec4 base_color;
    vec4 emissive;       // w: strength of the occlusion texture
    float alpha_cutoff;  // fragments below it are left out, in the pipeline that discards
    uint double_sided;
    uint first_morph, morph_count;  // of the section; count 0: none
    uint lod;                       // the level of detail that is drawn, if instances are listed
    float metallic, roughness;
    float normal_scale;  // 0: there is no normal map
    uint vertex_count;   // of the character
    uint has_skin_pool;  // skin matrices lie where skin_rows says
    uint section, section_count;
    uint active_morph_limit;  // morph_io.h
    uint material;            // instances with another SectionLook::material are not drawn
    uint first_layer;         // coverage.glsl
    float size;               // of the character at rest
};

// A joint, as its line is drawn.
struct JointLevel {
    uint parent;  // or kNone
    uint level;
};

// Push constants of the lines over a crowd.
struct LinePush {
    vec4 box_centre, box_half_extent;  // of boxes: model space
    uint joint_count;                  // of skeletons
    uint level_count;
    uint instance_count;
    uint unused0;
};

THRONG_IO_END
#endif
