// What the sample stage reads and writes. Shared by C++ and GLSL.
#ifndef THRONG_SAMPLE_IO_H
#define THRONG_SAMPLE_IO_H
#include "control/control_io.h"
THRONG_IO_BEGIN

THRONG_IO_CONSTANT kSampleWorkgroupSize = 64;

// The same values as in throng/character.h.
THRONG_IO_CONSTANT kTrackAnimatedBit = 0x80000000u;
THRONG_IO_CONSTANT kTrackStepBit = 0x40000000u;
THRONG_IO_CONSTANT kTrackPositionMask = 0x3FFFFFFFu;
THRONG_IO_CONSTANT kPackedBitsMask = 0x7FFFu;
THRONG_IO_CONSTANT kPackedLeftOutShift = 15;
THRONG_IO_CONSTANT kPackedFull = 1u << 17;
THRONG_IO_CONSTANT kPackedStep = 1u << 18;
THRONG_IO_CONSTANT kPackedFullBits = 16;

// parent_from_joint before it becomes a matrix; w of translation and scale is unused.
struct JointPose {
    vec4 rotation;
    vec4 translation;
    vec4 scale;
};

struct SamplePush {
    uint joint_count;
    uint is_second;  // 0: the first clip of each instance, 1: the second
};

THRONG_IO_END
#endif
