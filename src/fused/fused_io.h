// Constants and parameters of the fused kernel, besides those of its stages. Shared by C++ and GLSL.
#ifndef THRONG_FUSED_IO_H
#define THRONG_FUSED_IO_H
#include "gpu/shader_types.h"
THRONG_IO_BEGIN

// Specialization constants; 1 to 7 are the scan method's.
THRONG_IO_CONSTANT kPackedId = 8;
THRONG_IO_CONSTANT kBlendsId = 9;
THRONG_IO_CONSTANT kKeepsModelId = 10;
THRONG_IO_CONSTANT kSkinFormatId = 11;
THRONG_IO_CONSTANT kOneBindId = 12;
THRONG_IO_CONSTANT kTileInstancesId = 13;
THRONG_IO_CONSTANT kTileTransformsId = 14;
THRONG_IO_CONSTANT kLayeredId = 15;
THRONG_IO_CONSTANT kSocketCountId = 16;
THRONG_IO_CONSTANT kInertialId = 17;
THRONG_IO_CONSTANT kPoseOverridesId = 18;
THRONG_IO_CONSTANT kListedId = 19;
THRONG_IO_CONSTANT kMapsJointsId = 20;
THRONG_IO_CONSTANT kRowJointsId = 21;
THRONG_IO_CONSTANT kOtherColumnsId = 22;
THRONG_IO_CONSTANT kFineRotationsId = 23;
THRONG_IO_CONSTANT kMotionsId = 24;
THRONG_IO_CONSTANT kFineMotionsId = 25;
THRONG_IO_CONSTANT kPlainEntriesId = 26;
THRONG_IO_CONSTANT kSkinPoolId = 27;
THRONG_IO_CONSTANT kFusedConstants = 28;  // count, including that of the workgroup size

// links[] of fused/serial.comp: the number of segments, two counts for each, then the walk (scan/pieces_io.h).
THRONG_IO_CONSTANT kSegmentCount = 0;
THRONG_IO_CONSTANT kFirstSegment = 1;

struct FusedPush {
    uint joint_count;      // animated joints
    uint rig_joint_count;  // all joints of the rig
    uint instance_count;
    uint palette_count;
    uint rest_track;         // of the rest pose in `tracks`: clip_count * rig_joint_count
    uint active_clip_limit;  // with layers: active clips kept for each instance
    uint section;            // of the work list (cull/cull_io.h), if instances are listed
};

THRONG_IO_END
#endif
