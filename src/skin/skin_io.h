// What the skin stage and the draw read. Shared by C++ and GLSL.
#ifndef THRONG_SKIN_IO_H
#define THRONG_SKIN_IO_H
#include "gpu/shader_types.h"
THRONG_IO_BEGIN

THRONG_IO_CONSTANT kSkinWorkgroupSize = 64;

// throng::SkinBlend
THRONG_IO_CONSTANT kSkinLinear = 0;
THRONG_IO_CONSTANT kSkinDualQuaternion = 1;

// throng::Vertex as eight words: the bits of three floats, the position; normal; the bits of two floats, the texture
// coordinate; colour; first_delta. Normal and first_delta must not go through a float: some would be denormal, and a
// device may take these for 0.
struct VertexRows {
    uvec4 position_normal;
    uvec4 texcoord_color_delta;
};

// A section of a mesh in one level of detail.
struct SkinSection {
    uint first_vertex;
    uint first_influences;
    uint influence_sets;
    uint first_morph, morph_count;    // count 0: none
    uint first_listed, listed_count;  // which of its vertices the level has
    uint unused;
};

struct SkinPush {
    uint section_count;
    uint vertex_count, palette_count;  // of the character
    uint first_instance;               // where nothing is listed; its vertices are written first
    uint influence_offset;             // likewise: the distance from the section's influences
    uint only_animated;                // of those listed, only instances animated in this half of the update
    uint has_skin_pool;                // skin matrices lie where skin_rows says
    uint active_morph_limit;           // morph_io.h
};

THRONG_IO_END
#endif
