// What the morph stage reads and writes. Shared by C++ and GLSL.
#ifndef THRONG_MORPH_IO_H
#define THRONG_MORPH_IO_H
#include "gpu/shader_types.h"
THRONG_IO_BEGIN

THRONG_IO_CONSTANT kMorphWorkgroupSize = 64;

// kMorphNormalStep and kLeastMorphWeight of throng/character.h, as the bits of floats.
THRONG_IO_CONSTANT kMorphNormalStepBits = 0x3B804020u;
THRONG_IO_CONSTANT kLeastMorphWeightBits = 0x358637BDu;

// A morph that an instance shows; weight 0: none, and none after it.
struct ActiveMorph {
    uint morph;
    float weight;
};

// A clip's track of a morph: the position of its weight, or of that in the first row, and flags; as JointTracks.
// kNone where the clip does not animate it.
THRONG_IO_CONSTANT kMorphAnimatedBit = 0x80000000u;
THRONG_IO_CONSTANT kMorphStepBit = 0x40000000u;
THRONG_IO_CONSTANT kMorphPositionMask = 0x3FFFFFFFu;

struct MorphPush {
    uint instance_count;
    uint morph_count;
    uint joint_count;         // of layers: an active clip's clip is its first track divided by this
    uint active_clip_limit;   // of layers: active clips kept for each instance
    uint active_morph_limit;  // entries of active_morphs for each instance; morph_count: all that have weight
};

THRONG_IO_END
#endif
