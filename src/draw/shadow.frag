// shadow: discards fragments below the mask's alpha cutoff; writes only depth.
#include "draw/draw_io.h"

layout(set = 2, binding = 0) uniform sampler2D base_color_texture;
PUSH(DrawPush);
layout(location = 2) in vec2 in_texcoord;
layout(location = 3) in vec4 in_color;

void main() {
    if (texture(base_color_texture, in_texcoord).a * push.base_color.a * in_color.a < push.alpha_cutoff) discard;
}
