// What the skin stage and the draw read. Shared by C++ and GLSL.
#ifndef THRONG_SKIN_IO_H
#define THRONG_SKIN_IO_H
#include "gpu/shader_types.h"
THRONG_IO_BEGIN

THRONG_IO_CONSTANT kSkinWorkgroupSize = 64;

// throng::Vertex as a float4, position and normal (its bits), and four words: the bits of two floats, the texture coordinate; colour; first_delta. A number as
// small as first_delta may not go through a float: as one it would be denormal, and a device may take it for 0.
struct VertexRows {
    vec4 position_normal;
    uvec4 texcoord_color_delta;
};

// A section of a mesh, for one instance.
struct SkinPush {
    uint first_vertex;
    uint vertex_count;
    uint first_influences;
    uint influence_sets;
    uint first_palette_entry;  // of the instance: instance * palette_count
    uint first_morph, morph_count;  // of the section; count 0: none
    uint first_active;         // of the instance: instance * kActiveMorphs
};

THRONG_IO_END
#endif
