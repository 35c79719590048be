#version 460
// shadow: the ground where the sun does not arrive. It writes the ground's colour anew instead of blending over it, so that triangles
// of a shadow may overlap.
#include "draw/draw_io.h"

layout(set = 0, binding = 0, std140) uniform Scene { DrawScene scene; };
layout(location = 0) in vec3 in_world;
layout(location = 0) out vec4 out_color;

#include "draw/light.glsl"

void main() {
    const float kLeak = 0.25;  // a shadow that is not quite black looks soft
    out_color = vec4(ground_color(in_world, kLeak), 1);
}
