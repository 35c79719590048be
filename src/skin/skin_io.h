// What the skin stage and the draw read. Shared by C++ and GLSL.
#ifndef THRONG_SKIN_IO_H
#define THRONG_SKIN_IO_H
#include "gpu/shader_types.h"
THRONG_IO_BEGIN

THRONG_IO_CONSTANT kSkinWorkgroupSize = 64;

// throng::SkinBlend
THRONG_IO_CONSTANT kSkinLinear = 0;
THRONG_IO_CONSTANT kSkinDualQuaternion = 1;

// throng::Vertex as eight words: position (bits of three floats), normal, texture coordinate (bits of two floats),
// colour, first_delta. Declared as integers, since as floats some normals and first_deltas would be denormals, which a
// device may flush to 0.
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
    uint vertex_count;                // of all levels; level 0 lists the others behind its own
};

struct SkinPush {
    uint section_count;
    uint vertex_count, palette_count;  // of the character
    uint first_instance;               // if instances are not listed; its vertices are written first
    uint influence_offset;             // if instances are not listed: added to each section's first_influences
    uint only_animated;                // if listed: skips instances not animated in this half of the update
    uint has_skin_pool;                // skin_rows tells where an instance's skin matrices lie
    uint active_morph_limit;           // morph_io.h
};

THRONG_IO_END
#endif
