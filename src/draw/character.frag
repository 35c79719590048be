// character: its material, lit.
#include "draw/scene.glsl"

CONSTANT(0, bool, kDiscards, false);  // masked materials, and batches with mirrored instances
CONSTANT(1, bool, kMaps, false);      // materials with more textures than that of the base colour

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
layout(location = 0) out vec4 out_color;

#include "draw/light.glsl"

// The normal map's normal. Its tangents are the derivatives of the place by the texture's coordinates (C. Schüler,
// Normal Mapping Without Precomputed Tangents, in ShaderX5, 2006); y of the map goes against v, as glTF has it.
vec3 mapped_normal(vec3 normal) {
    const vec3 along_x = dFdx(in_world), along_y = dFdy(in_world);
    const vec2 texture_x = dFdx(in_texcoord), texture_y = dFdy(in_texcoord);
    const float area = texture_x.x * texture_y.y - texture_y.x * texture_x.y;
    const float side = area < 0 ? -1 : 1;
    vec3 u = (texture_y.y * along_x - texture_x.y * along_y) * side,
         v = (texture_x.x * along_y - texture_y.x * along_x) * side;
    u -= normal * dot(normal, u);
    v -= normal * dot(normal, v);
    const vec3 map = texture(normal_texture, in_texcoord).xyz * 2 - 1;
    const vec3 tilted = normal * map.z + (map.x * push.normal_scale) * u * inversesqrt(max(dot(u, u), 1e-30)) -
                        (map.y * push.normal_scale) * v * inversesqrt(max(dot(v, v), 1e-30));
    return push.normal_scale != 0 && area != 0 ? normalize(tilted) : normal;
}

void main() {
    const vec4 color = texture(base_color_texture, in_texcoord) * push.base_color * in_color;
    const bool front = gl_FrontFacing != (in_mirrored != 0);
    if (kDiscards) {
        if (color.a < push.alpha_cutoff) discard;
        if (!front && push.double_sided == 0) discard;
    }
    const vec3 smooth_normal = normalize(in_normal);
    // The nearer to the ground, the less of the sky is seen.
    const float open = mix(0.5, 1.0, smoothstep(0.0, 0.25, (in_world.y - scene.ground.y) / scene.ground.w));
    Surface surface = Surface(color.rgb, push.metallic, push.roughness, smooth_normal, open, push.emissive.rgb);
    if (kMaps) {
        const vec4 metallic_roughness = texture(metallic_roughness_texture, in_texcoord);
        surface.metallic *= metallic_roughness.b;
        surface.roughness *= metallic_roughness.g;
        surface.normal = mapped_normal(smooth_normal);
        surface.occlusion *= mix(1, texture(occlusion_texture, in_texcoord).r, push.emissive.w);
        surface.emissive *= texture(emissive_texture, in_texcoord).rgb;
    }
    if (!front) surface.normal = -surface.normal;
    const float sun = sun_at(in_world, front ? smooth_normal : -smooth_normal);
    const vec3 light = reflected_light(surface, normalize(scene.eye.xyz - in_world), sun);
    out_color = vec4(tone_mapped(through_fog(light, in_world)), 1);
}
