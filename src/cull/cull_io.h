// What the cull stage reads and writes. Shared by C++ and GLSL.
#ifndef THRONG_CULL_IO_H
#define THRONG_CULL_IO_H
#include "gpu/shader_types.h"
THRONG_IO_BEGIN

THRONG_IO_CONSTANT kCullWorkgroupSize = 64;
THRONG_IO_CONSTANT kDetailLevels = 4;        // levels of detail of a character; 0 is the finest
THRONG_IO_CONSTANT kUnseen = 0xFFFFFFFFu;   // in place of a level

// The list of a batch: how many instances are drawn; where those of each level begin behind kListBegins + kDetailLevels; then the instances, finest level
// first, each level's in ascending order.
THRONG_IO_CONSTANT kListCount = 0;
THRONG_IO_CONSTANT kListBegins = 1;
THRONG_IO_CONSTANT kFirstListed = 5;

// What is drawn; world space.
struct CullView {
    vec4 planes[6];  // a point p is inside where dot(xyz, p) + w >= 0
    vec4 eye;        // w: the pixels that a length of 1 takes at a distance of 1, over those by which a level of detail may be off
    vec4 shadow;     // how far a point's shadow falls: what is drawn throws one
};

// Of the characters of a batch.
struct CullPush {
    vec4 centre;         // of the box that holds all of a character's poses, model space
    vec4 half_extent;
    vec4 detail_errors;  // model space: how far a level is off
    uint instance_count;
    uint detail_count;
    uint unused0, unused1;
};

struct OffsetsPush {
    uint workgroup_count;        // of the cull kernel
    uint section_count;
    uint instances_of_workgroup; // of the kernel that animates what is drawn
};

// VkDrawIndexedIndirectCommand.
struct DrawCommand {
    uint index_count;
    uint instance_count;
    uint first_index;
    uint vertex_offset;
    uint first_instance;
};

THRONG_IO_END
#endif
