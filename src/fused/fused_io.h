// What the fused kernel reads and writes beside its stages' own. Shared by C++ and GLSL.
#ifndef THRONG_FUSED_IO_H
#define THRONG_FUSED_IO_H
#include "gpu/shader_types.h"
THRONG_IO_BEGIN

THRONG_IO_CONSTANT kMethodConstants = 7;  // specialization constants 1 to 7 are the scan method's

// links[] of fused/serial.comp: the number of segments, two counts for each, then the walk (scan/pieces_io.h).
THRONG_IO_CONSTANT kSegmentCount = 0;
THRONG_IO_CONSTANT kFirstSegment = 1;

struct FusedPush {
    uint joint_count;      // that are animated
    uint rig_joint_count;  // that there are
    uint instance_count;
    uint palette_count;
    uint rest_track;         // of the rest pose in `tracks`: clip_count * rig_joint_count
    uint active_clip_limit;  // of layers: active clips kept for each instance
    uint section;            // of the work (cull/cull_io.h), where instances are listed
};

THRONG_IO_END
#endif
