#version 460
// ground: where the ray meets the ground, or the sky.
#include "draw/draw_io.h"

layout(set = 0, binding = 0, std140) uniform Scene { DrawScene scene; };
layout(location = 0) in vec3 in_ray;
layout(location = 0) out vec4 out_color;

#include "draw/light.glsl"

void main() {
    // Rays that miss the ground get a point of it too, so that its derivatives are defined for their neighbours.
    const bool meets = in_ray.y < 0 && scene.eye.y > scene.ground.y;
    const float reach = (scene.ground.y - scene.eye.y) / min(in_ray.y, -1e-6);
    const vec3 ground = ground_color(scene.eye.xyz + reach * in_ray, 1);
    out_color = vec4(meets ? ground : sky_color(in_ray), 1);
}
