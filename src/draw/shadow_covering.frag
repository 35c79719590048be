// shadow_covering: leaves out the samples that a blended material does not cover.
#include "draw/covering.glsl"
#include "draw/scene.glsl"

layout(set = 2, binding = 0) uniform sampler2D base_color_texture;
PUSH(DrawPush);
layout(location = 2) in vec2 in_texcoord;
layout(location = 3) in vec4 in_color;

void main() {
    const uvec2 texel = uvec2(gl_FragCoord.xy) + uvec2(scene.map_grid.xy);
    cover(texture(base_color_texture, in_texcoord).a * push.base_color.a * in_color.a, texel);
}
