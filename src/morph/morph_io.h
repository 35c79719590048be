// What the morph stage reads and writes. Shared by C++ and GLSL.
#ifndef THRONG_MORPH_IO_H
#define THRONG_MORPH_IO_H
#include "gpu/shader_types.h"
THRONG_IO_BEGIN

THRONG_IO_CONSTANT kMorphWorkgroupSize = 64;

// kMorphNormalStep and kMinMorphWeight of throng/character.h, as the bits of floats.
THRONG_IO_CONSTANT kMorphNormalStepBits = 0x3B804020u;
THRONG_IO_CONSTANT kMinMorphWeightBits = 0x358637BDu;

// A morph that an instance shows. Weight 0 ends the list.
struct ActiveMorph {
    uint morph;
    float weight;
};

// A clip's track of a morph, encoded like JointTracks: flags, and the position of its constant weight or of its weight
// in the first row. kNone if the clip does not animate the morph.
THRONG_IO_CONSTANT kMorphAnimatedBit = 0x80000000u;
THRONG_IO_CONSTANT kMorphStepBit = 0x40000000u;
THRONG_IO_CONSTANT kMorphPositionMask = 0x3FFFFFFFu;

struct MorphPush {
    uint instance_count;
    uint morph_count;
    uint joint_count;         // with layers: the index of an active clip's clip is its first track / joint_count
    uint active_clip_limit;   // with layers: active clips kept for each instance
    uint active_morph_limit;  // entries of active_morphs for each instance; morph_count: no limit
};

THRONG_IO_END
#endif
