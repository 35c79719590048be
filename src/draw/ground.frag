// ground: where the ray meets the ground, or the sky.
#include "draw/scene.glsl"

layout(set = 1, binding = 0) uniform sampler2D shadow_map;
layout(location = 0) in vec3 in_ray;
layout(location = 0) out vec4 out_color;

#include "draw/light.glsl"
#include "draw/ground_model.glsl"

void main() { out_color = vec4(background(in_ray, fwidth(ground_position(ground_point(in_ray)))), 1); }
