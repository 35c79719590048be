// shadow_covering: leaves out the samples that a blended material does not cover, in the shadow map or in the depths of
// occluders.
#include "draw/covering.glsl"
#include "draw/scene.glsl"

CONSTANT(3, bool, kIntoMap, false);  // else the pattern is the picture's, so that the same samples show through

layout(set = 2, binding = 0) uniform sampler2D base_color_texture;
PUSH(DrawPush);
layout(location = 2) in vec2 in_texcoord;
layout(location = 3) in vec4 in_color;

void main() {
    uvec2 pixel = uvec2(gl_FragCoord.xy);
    if (kIntoMap) pixel = (pixel + uvec2(scene.map_grid.xy)) & 65535u;
    cover(texture(base_color_texture, in_texcoord).a * push.base_color.a * in_color.a, pixel);
}
