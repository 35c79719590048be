#version 460
// character: texture, factor and vertex colour, lit.
#include "draw/draw_io.h"

layout(constant_id = 0) const bool kDiscards = false;  // masked materials, and batches with mirrored instances

layout(set = 0, binding = 0, std140) uniform Scene { DrawScene scene; };
layout(set = 2, binding = 0) uniform sampler2D base_color_texture;
layout(push_constant) uniform Push { DrawPush push; };

layout(location = 0) in vec3 in_world;
layout(location = 1) in vec3 in_normal;
layout(location = 2) in vec2 in_texcoord;
layout(location = 3) in vec4 in_color;
layout(location = 4) flat in uint in_mirrored;
layout(location = 0) out vec4 out_color;

#include "draw/light.glsl"

void main() {
    const vec4 color = texture(base_color_texture, in_texcoord) * push.base_color * in_color;
    const bool front = gl_FrontFacing != (in_mirrored != 0);
    if (kDiscards) {
        if (color.a < push.alpha_cutoff) discard;
        if (!front && push.double_sided == 0) discard;
    }
    const vec3 normal = normalize(front ? in_normal : -in_normal);
    out_color = vec4(surface_color(color.rgb, in_world, normal), 1);
}
