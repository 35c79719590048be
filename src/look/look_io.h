// How instances look. Shared by C++ and GLSL.
#ifndef THRONG_LOOK_IO_H
#define THRONG_LOOK_IO_H
#include "gpu/shader_types.h"
THRONG_IO_BEGIN

// throng::InstanceLook
struct InstanceLook {
    float red, green, blue;  // the tint
    uint outfit;
};

// A section in an outfit.
struct SectionLook {
    float red, green, blue;  // factor of the base colour
    float tint;              // how strongly the instance's tint applies, 0..1
    uint material;           // index in Group::materials; their count: the default one; kNone: not shown
};

THRONG_IO_END
#endif
