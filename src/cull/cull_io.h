// What the cull stage reads and writes. Shared by C++ and GLSL.
#ifndef THRONG_CULL_IO_H
#define THRONG_CULL_IO_H
#include "gpu/shader_types.h"
THRONG_IO_BEGIN

THRONG_IO_CONSTANT kCullWorkgroupSize = 64;
// A cell is as many consecutive instances as a workgroup has invocations. In large batches a workgroup goes through
// several cells, so that the offsets kernel does not have to go through too many workgroups.
THRONG_IO_CONSTANT kMaxCells = 64;      // of a workgroup
THRONG_IO_CONSTANT kLodCount = 4;       // levels of detail of a character; 0 is the finest
THRONG_IO_CONSTANT kMaxPeriodLog2 = 3;  // the smallest instances are animated in every eighth update

// The list of a batch: how many instances are drawn; where each level's instances begin, counted from kFirstListed;
// then the instances, finest level first, each level's in ascending order.
THRONG_IO_CONSTANT kListCount = 0;
THRONG_IO_CONSTANT kListBegins = 1;
THRONG_IO_CONSTANT kFirstListed = 5;

// A workgroup counts the verdicts on its instances: those drawn, by level of detail, then those in each section of the
// work.
THRONG_IO_CONSTANT kCounters = 16;  // of a workgroup

// The work of a batch. For each section two words: where its instances begin, as an index into the work, and how many
// there are. Then, at kOwnRowsBefore, how many rows of a skin pool the first half of the update has given out (0 in
// that half itself), and at kOwnRowsTaken how many both halves have. Then the instances, section by section, in
// ascending order within each. The sections:
// - kAnimated + k: instances that are animated with joint set k;
// - kAnimatedAhead + k: the same, but for the pose of a later update;
// - kInterpolated: instances whose skin matrices are interpolated towards that later pose, or only kept;
// - kAppearing: instances that were not drawn in the last update, or with fewer joints; only if previous skin matrices
//   are kept, which are set to the current ones.
THRONG_IO_CONSTANT kAnimated = 0;
THRONG_IO_CONSTANT kAnimatedAhead = 4;
THRONG_IO_CONSTANT kInterpolated = 8;
THRONG_IO_CONSTANT kAppearing = 9;
THRONG_IO_CONSTANT kWorkSections = 10;
THRONG_IO_CONSTANT kOwnRowsBefore = 20;
THRONG_IO_CONSTANT kOwnRowsTaken = 21;
THRONG_IO_CONSTANT kFirstWork = 22;
THRONG_IO_CONSTANT kMaxWorkOfInstance = 2;  // sections that an instance is in at most

// A verdict on an instance, for one update.
THRONG_IO_CONSTANT kVerdictLodMask = 3u;
THRONG_IO_CONSTANT kVerdictInView = 4u;
THRONG_IO_CONSTANT kVerdictDrawn = 8u;
THRONG_IO_CONSTANT kVerdictAnimated = 16u;  // in the section of the next three bits
THRONG_IO_CONSTANT kVerdictSectionShift = 5;
THRONG_IO_CONSTANT kVerdictSectionMask = 7u;
THRONG_IO_CONSTANT kVerdictInterpolated = 256u;
THRONG_IO_CONSTANT kVerdictAppears = 512u;

// What is kept of an instance from one update to the next.
THRONG_IO_CONSTANT kStateDrawn = 1u;     // in the last update; its skin matrices are from then
THRONG_IO_CONSTANT kStateVisible = 2u;   // not hidden in the last update
THRONG_IO_CONSTANT kStateLeftShift = 2;  // updates until its matrices reach the next pose
THRONG_IO_CONSTANT kStateLeftMask = 15u;
THRONG_IO_CONSTANT kStateStepShift = 6;  // in this update they move 1 / step of the remaining way; 0: none
THRONG_IO_CONSTANT kStateStepMask = 15u;
THRONG_IO_CONSTANT kStateSetShift = 10;  // joint set of its matrices, or of the pose they move to

// A view, in world space.
struct CullView {
    vec4 planes[6];           // a point p is inside where dot(xyz, p) + w >= 0
    vec4 clip_from_world[4];  // rows
    // w: the pixels that a length of 1 covers at a distance of 1, divided by the error in pixels allowed to a level of
    // detail
    vec4 eye;
    // The longest way that the shadow of a point falls: an instance also counts as seen if its shadow may be. w: the
    // pixels that a length of 1 covers at a distance of 1, divided by the size in pixels from which characters are
    // animated in every update; 0: all are
    vec4 shadow;
    uint update_number;  // modulo 2^32
    uint occlusion;      // whether instances hidden in the last update wait for reveal
    float ground;        // y: no shadow falls below it
    // Pixels of a length of 1 at a distance of 1, divided by the error in pixels allowed to a shared pose
    float shared_pixels;
};

// Poses of a clip that instances share, at equal intervals of time from its beginning to its end.
struct SharedClip {
    uint first_row;  // of the skin matrices
    uint interval_count;
    float intervals_per_s;  // 0: the clip has no length
    float error;            // model space: the largest error of the nearest shared pose
};

// A box around the boxes of a cell's instances.
struct Cell {
    vec4 middle;  // world space; w: CullPush::placements_version that it was made of
    vec4 half_extent;
};

// What the characters of a batch have in common.
struct CullPush {
    vec4 centre;  // of the box that holds all of a character's poses, model space
    vec4 half_extent;
    vec4 lod_errors;  // model space: the error of each level
    uint instance_count;
    uint lod_count;
    uint joint_set_count;  // level k has the joints of set min(k, joint_set_count - 1)
    uint keeps_previous;   // skin matrices of the previous update are kept
    uint may_skip;         // instances need not be animated in every update
    // Of groups with a skin pool: rows that instances may have of their own; 0: there is no pool
    uint own_row_count;
    uint first_own_row;
    uint joint_count;
    uint active_clip_limit;  // of groups with a controller; else 0
    float pose_spread;       // model space: the largest distance between two poses of clips
    uint cells_of_workgroup;
    // Above 0, and another number whenever placements have changed; 0: placements change in every update, so there are
    // no cells
    float placements_version;
    uint birth;              // control/births.glsl
    uint animates_unlisted;  // instances that are not drawn are animated too, with all joints
    uint unused0, unused1;
};

// The depth pyramid: depths of a picture, greater where nearer, each level half as fine as the one before, down to one
// texel. A level has half the texels of the one before it along x and y, rounded up; each texel is the farthest of
// those that it covers. Level 0 is made from the picture itself. Levels lie one after the other, row by row.
struct PyramidPush {
    uint width, height;              // of what is read
    uint first_read, first_written;  // floats
    float sign;                      // depth * sign is greater where it is nearer
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
