// What the cull stage reads and writes. Shared by C++ and GLSL.
#ifndef THRONG_CULL_IO_H
#define THRONG_CULL_IO_H
#include "gpu/shader_types.h"
THRONG_IO_BEGIN

THRONG_IO_CONSTANT kCullWorkgroupSize = 64;
// A workgroup goes through several cells, each of as many consecutive instances as it has invocations, where a batch
// has so many instances that the offsets kernel would have to go through too many workgroups.
THRONG_IO_CONSTANT kMostCells = 64;      // of a workgroup
THRONG_IO_CONSTANT kLodCount = 4;        // levels of detail of a character; 0 is the finest
THRONG_IO_CONSTANT kMostPeriodLog2 = 3;  // what is smallest is animated in every eighth update

// The list of a batch: how many instances are drawn; where those of each level begin behind kFirstListed; then the
// instances, finest level first, each level's in ascending order.
THRONG_IO_CONSTANT kListCount = 0;
THRONG_IO_CONSTANT kListBegins = 1;
THRONG_IO_CONSTANT kFirstListed = 5;

// A verdict is given on each instance, sections of instances with the same are counted: those drawn of each level of
// detail, then those of the work.
THRONG_IO_CONSTANT kCounters = 16;  // of a workgroup

// The work of a batch: for each section where it begins, in words from the first, and how many instances it has; then
// the instances, section by section, each one's in ascending order. A section of instances that are animated, for each
// set of joints; of those animated towards a later update, likewise; of those whose matrices go on towards that; and of
// those that are drawn anew. Before the instances stands how many rows of a skin pool the first half of the update has
// given away, and how many both have.
THRONG_IO_CONSTANT kAnimated = 0;
THRONG_IO_CONSTANT kAnimatedAhead = 4;
THRONG_IO_CONSTANT kGoingOn = 8;
THRONG_IO_CONSTANT kAppearing = 9;
THRONG_IO_CONSTANT kWorkSections = 10;
THRONG_IO_CONSTANT kOwnRowsBefore = 20;
THRONG_IO_CONSTANT kOwnRowsTaken = 21;
THRONG_IO_CONSTANT kFirstWork = 22;
THRONG_IO_CONSTANT kMostWorkOfInstance = 2;  // sections that an instance is in at most

// A verdict on an instance, for one update.
THRONG_IO_CONSTANT kVerdictLodMask = 3u;
THRONG_IO_CONSTANT kVerdictInView = 4u;
THRONG_IO_CONSTANT kVerdictDrawn = 8u;
THRONG_IO_CONSTANT kVerdictAnimated = 16u;  // in the section of the next three bits
THRONG_IO_CONSTANT kVerdictSectionShift = 5;
THRONG_IO_CONSTANT kVerdictSectionMask = 7u;
THRONG_IO_CONSTANT kVerdictGoesOn = 256u;
THRONG_IO_CONSTANT kVerdictAppears = 512u;

// What is kept of an instance from one update to the next.
THRONG_IO_CONSTANT kStateDrawn = 1u;     // in the last one; its skin matrices are those of then
THRONG_IO_CONSTANT kStateVisible = 2u;   // not hidden in the last one
THRONG_IO_CONSTANT kStateLeftShift = 2;  // of the updates that its matrices still take to the next pose
THRONG_IO_CONSTANT kStateLeftMask = 15u;
THRONG_IO_CONSTANT kStateStepShift = 6;  // of the part of the way that they take in this one: 1 / it; 0: none
THRONG_IO_CONSTANT kStateStepMask = 15u;
THRONG_IO_CONSTANT kStateSetShift = 10;  // of the set of joints that they have, or are going on to

// What is drawn; world space.
struct CullView {
    vec4 planes[6];           // a point p is inside where dot(xyz, p) + w >= 0
    vec4 clip_from_world[4];  // rows
    // w: the pixels that a length of 1 takes at a distance of 1, over those by which a level of detail may be off
    vec4 eye;
    // How far a point's shadow falls at most: what is drawn throws one. w: pixels of a length of 1 at a distance of 1,
    // over those from which on characters are animated in every update; 0: all are
    vec4 shadow;
    uint update_number;  // modulo 2^32
    uint occlusion;      // whether what was hidden in the last update waits
    float ground;        // y: no shadow falls below it
    // Pixels of a length of 1 at a distance of 1, over those by which a shared pose may be off
    float shared_pixels;
};

// Poses of a clip that instances share, at equal intervals of time from its beginning to its end.
struct SharedClip {
    uint first_row;  // of the skin matrices
    uint interval_count;
    float intervals_per_s;  // 0: the clip has no length
    float error;            // model space: how far the nearest of them is off at most
};

// A box around those of a cell's instances.
struct Cell {
    vec4 middle;  // world space; w: CullPush::placements_version that it was made of
    vec4 half_extent;
};

// What the characters of a batch have in common.
struct CullPush {
    vec4 centre;  // of the box that holds all of a character's poses, model space
    vec4 half_extent;
    vec4 lod_errors;  // model space: how far a level is off
    uint instance_count;
    uint lod_count;
    uint joint_set_count;  // level k has the joints of set min(k, joint_set_count - 1)
    uint keeps_previous;   // skin matrices of the update before
    uint may_skip;         // not animated in every update
    // Of groups with a skin pool: rows that instances may have of their own; 0: there is no pool
    uint own_row_count;
    uint first_own_row;
    uint joint_count;
    uint active_clip_limit;  // of groups with a controller; else 0
    float pose_spread;       // model space: how far two poses of clips are apart at most
    uint cells_of_workgroup;
    // Another whenever placements have changed, above 0; 0: they always do, and there are no cells
    float placements_version;
    uint birth;              // control/births.glsl
    uint animates_unlisted;  // instances that are not drawn are animated too, all of their joints
    uint unused0, unused1;
};

// The depth pyramid: depths of a picture, greater where nearer, half as fine level by level, down to one texel. A level
// has half the texels of the one before it along x and y, rounded up; each is the farthest of those that it covers.
// Level 0 is made of the picture itself. All lie one after the other, in rows.
struct PyramidPush {
    uint width, height;              // of what is read
    uint first_read, first_written;  // floats
    float sign;                      // what is read times this is greater where it is nearer
};

struct RevealPush {
    CullPush cull;
    uint width, height;  // of the picture
    float sign;          // PyramidPush's
    uint unused;
};

struct OffsetsPush {
    uint workgroup_count;          // of the cull kernel
    uint section_count;            // of the mesh
    uint own_row_count;            // CullPush's
    uint is_second_half;           // of an update
    uvec4 instances_of_workgroup;  // of the kernels that animate, by joint set
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
