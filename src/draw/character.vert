#version 460
// character: morphs, skins and places one vertex of one instance. gl_VertexIndex counts within the section, gl_InstanceIndex within the batch, or within
// the listed instances of a level of detail.
#include "cull/cull_io.h"
#include "draw/draw_io.h"
#include "gpu/affine.glsl"
#include "morph/morph_io.h"
#include "skin/skin_io.h"

layout(constant_id = 0) const bool kShadow = false;  // as the sun sees it, for the shadow map
layout(constant_id = 1) const uint kSkinFormat = 0;  // throng::SkinFormat
layout(constant_id = 2) const bool kListed = false;  // what is drawn lies in list

layout(set = 0, binding = 0, std140) uniform Scene { DrawScene scene; };
layout(set = 1, binding = 0, std430) readonly buffer Vertices { VertexRows vertices[]; };
layout(set = 1, binding = 1, std430) readonly buffer InfluenceWords { uvec2 influences[]; };
layout(set = 1, binding = 3, std430) readonly buffer Placements { Affine world_from_model[]; };
layout(set = 1, binding = 4, std430) readonly buffer MorphDeltas { uvec4 morph_deltas[]; };
layout(set = 1, binding = 5, std430) readonly buffer ActiveMorphs { ActiveMorph active_morphs[]; };
layout(set = 1, binding = 6, std430) readonly buffer List { uint list[]; };  // cull/cull_io.h
layout(push_constant) uniform Push { DrawPush push; };

layout(location = 0) out vec3 out_world;
layout(location = 1) out vec3 out_normal;
layout(location = 2) out vec2 out_texcoord;
layout(location = 3) out vec4 out_color;
layout(location = 4) flat out uint out_mirrored;

#define SKIN_SET 1
#define SKIN_BINDING 2
#include "bind/skin_format.glsl"
#include "skin/skin.glsl"
#include "morph/apply.glsl"

// The inverse of pack_normal() in compile/mesh.cpp.
vec3 unpack_normal(uint packed) {
    const vec2 octahedral = unpackSnorm2x16(packed);
    const float z = 1 - abs(octahedral.x) - abs(octahedral.y);
    const vec2 folded = (1 - abs(octahedral.yx)) * mix(vec2(-1), vec2(1), greaterThanEqual(octahedral, vec2(0)));
    return vec3(z < 0 ? folded : octahedral, z);
}

// The inverse transpose of m's linear part but for a positive factor: right for non-uniform scale, and for mirrors.
vec3 transform_normal(Affine m, vec3 normal) {
    const vec3 c0 = cross(m.row1.xyz, m.row2.xyz), c1 = cross(m.row2.xyz, m.row0.xyz), c2 = cross(m.row0.xyz, m.row1.xyz);
    const vec3 cofactor = vec3(dot(c0, normal), dot(c1, normal), dot(c2, normal));
    return dot(m.row0.xyz, c0) < 0 ? -cofactor : cofactor;
}

void main() {
    const uint instance = kListed ? list[kFirstListed + list[kListBegins + push.detail] + gl_InstanceIndex] : gl_InstanceIndex;
    const VertexRows vertex = vertices[push.first_vertex + gl_VertexIndex];
    const MorphSum morphs = sum_of_morphs(vertex.texcoord_color_delta.w, push.first_morph, push.morph_count, instance * kActiveMorphs);
    const Affine placement = world_from_model[instance];
    const Affine model_from_bind = blended_skin_matrix(push.first_influences, push.influence_sets, gl_VertexIndex, instance * push.palette_count);
    const Affine world_from_bind = affine_multiply(placement, model_from_bind);
    const vec4 world = vec4(affine_point(world_from_bind, vertex.position_normal.xyz + morphs.position), 1);
    out_texcoord = uintBitsToFloat(vertex.texcoord_color_delta.xy);
    out_color = unpackUnorm4x8(vertex.texcoord_color_delta.z);
    if (kShadow) {
        gl_Position = vec4(2 * dot(scene.map_from_world[0], world) - 1, 2 * dot(scene.map_from_world[1], world) - 1, dot(scene.map_from_world[2], world), 1);
    } else {
        vec3 bind_normal = unpack_normal(floatBitsToUint(vertex.position_normal.w));
        if (push.morph_count > 0) bind_normal = normalize(bind_normal) + morphs.normal;
        const vec3 normal = transform_normal(world_from_bind, bind_normal);
        out_normal = normal * inversesqrt(max(dot(normal, normal), 1e-30));
        out_mirrored = dot(placement.row0.xyz, cross(placement.row1.xyz, placement.row2.xyz)) < 0 ? 1 : 0;
        out_world = world.xyz;
        gl_Position = vec4(dot(scene.clip_from_world[0], world), dot(scene.clip_from_world[1], world), dot(scene.clip_from_world[2], world), dot(scene.clip_from_world[3], world));
    }
}
