// A character's material, lit. With COVERS it is a blended one.
#include "draw/scene.glsl"

CONSTANT(0, bool, kDiscards, false);  // masked materials, and batches with mirrored instances
CONSTANT(1, bool, kMaps, false);      // materials with other textures than the base colour's

layout(set = 1, binding = 0) uniform sampler2D shadow_map;
layout(set = 2, binding = 0) uniform sampler2D base_color_texture;
layout(set = 2, binding = 1) uniform sampler2D metallic_roughness_texture;
layout(set = 2, binding = 2) uniform sampler2D normal_texture;
layout(set = 2, binding = 3) uniform sampler2D occlusion_texture;
layout(set = 2, binding = 4) uniform sampler2D emissive_texture;
PUSH(DrawPush);

layout(location = 0) in vec3 in_world;
layout(location = 1) in vec3 in_normal;
layout(location = 2) in vec2 in_texcoord;
layout(location = 3) in vec4 in_color;
layout(location = 4) flat in uint in_mirrored;
layout(location = 6) flat in float in_size;
layout(location = 0) out vec4 out_color;

#ifdef COVERS
#include "draw/covering.glsl"
#endif
#include "draw/light.glsl"
#include "draw/material_model.glsl"

void main() {
    // At the centre of a pixel that a triangle covers only in part, interpolated colours may lie outside the range of
    // the vertices' colours.
    const vec4 color = texture(base_color_texture, in_texcoord) * push.base_color * max(in_color, 0);
    const bool front = gl_FrontFacing != (in_mirrored != 0);
    // Before any discard: next to an invocation that has ended, derivatives and mip levels are undefined.
    MapTexels maps;
    PixelSteps steps;
    if (kMaps) {
        const vec4 metallic_roughness = texture(metallic_roughness_texture, in_texcoord);
        maps = MapTexels(metallic_roughness.b, metallic_roughness.g, texture(normal_texture, in_texcoord).xyz,
                         texture(occlusion_texture, in_texcoord).r, texture(emissive_texture, in_texcoord).rgb);
        steps = PixelSteps(dFdx(in_world), dFdy(in_world), dFdx(in_texcoord), dFdy(in_texcoord));
    }
    if (kDiscards) {
        if (!front && push.double_sided == 0) discard;
#ifdef COVERS
        cover(color.a, uvec2(gl_FragCoord.xy));
#else
        if (color.a < push.alpha_cutoff) discard;
#endif
    }
    const vec3 normal = normalize(in_normal);
    Surface surface = plain_surface(color.rgb, push.metallic, push.roughness, push.emissive.rgb, in_world, normal,
                                    in_size);
    if (kMaps) surface = mapped_surface(surface, maps, push.normal_scale, push.emissive.w, steps);
    out_color = vec4(pictured_surface(surface, in_world, normal, front), 1);
}
