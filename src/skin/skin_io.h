// What the skin stage and the draw read. Shared by C++ and GLSL.
#ifndef THRONG_SKIN_IO_H
#define THRONG_SKIN_IO_H
#include "gpu/shader_types.h"
THRONG_IO_BEGIN

THRONG_IO_CONSTANT kSkinWorkgroupSize = 64;

// throng::Vertex as two float4s: position and normal; texture coordinate, colour and first_delta (both as the bits of floats).
struct VertexRows {
    vec4 position_normal;
    vec4 texcoord_color;
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
