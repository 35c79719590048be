// character: morphs, skins and places one vertex of one instance. gl_VertexIndex counts within the character,
// gl_InstanceIndex within the batch, or within the listed instances of a level of detail.
#include "cull/cull_io.h"
#include "draw/scene.glsl"
#include "gpu/affine.glsl"
#include "look/look_io.h"
#include "morph/morph_io.h"
#include "skin/skin_io.h"

CONSTANT(0, bool, kShadow, false);  // as the sun sees it, for the shadow map
CONSTANT(1, uint, kSkinFormat, 0);  // throng::SkinFormat
CONSTANT(2, bool, kListed, false);  // the instances to draw are those of `list`
CONSTANT(3, uint, kSkinBlend, kSkinLinear);
// Reads vertices that the skin stage has skinned, in place of skin matrices
CONSTANT(4, bool, kSkinned, false);
CONSTANT(5, bool, kHasLooks, false);

READONLY_BUFFER(kVerticesBuffer, VertexRows, vertices);
READONLY_BUFFER(kInfluencesBuffer, uvec2, influences);
// [instance][vertex], throng::SkinnedVertex
READONLY_BUFFER(kSkinnedBuffer, uvec4, skinned);
READONLY_BUFFER(kPlacementsBuffer, Affine, world_from_model);
READONLY_BUFFER(kMorphDeltasBuffer, uvec4, morph_deltas);
READONLY_BUFFER(kActiveMorphsBuffer, ActiveMorph, active_morphs);
READONLY_BUFFER(kListBuffer, uint, list);  // cull/cull_io.h
READONLY_BUFFER(kSkinRowsBuffer, uint, skin_rows);
READONLY_BUFFER(kInstanceLooksBuffer, InstanceLook, instance_looks);
READONLY_BUFFER(kSectionLooksBuffer, SectionLook, section_looks);
PUSH(DrawPush);

layout(location = 0) out vec3 out_world;
layout(location = 1) out vec3 out_normal;
layout(location = 2) out vec2 out_texcoord;
layout(location = 3) out vec4 out_color;
layout(location = 4) flat out uint out_mirrored;
layout(location = 5) flat out uint out_layer;
layout(location = 6) flat out float out_size;

#include "bind/skin_format.glsl"
#include "skin/skin.glsl"
#include "skin/normal.glsl"
#include "morph/apply.glsl"
#include "look/look.glsl"
#include "draw/coverage.glsl"

struct ModelVertex {
    vec3 position, normal;  // model space; the normal is of any length
};

ModelVertex model_vertex(uint instance, VertexRows vertex) {
    if (kSkinned) {
        const uvec4 words = skinned[instance * push.vertex_count + gl_VertexIndex];
        return ModelVertex(uintBitsToFloat(words.xyz), unpack_normal(words.w));
    }
    const MorphSum morphs = sum_of_morphs(vertex.texcoord_color_delta.w, push.first_morph, push.morph_count, instance,
                                          push.active_morph_limit);
    const uint skin_row = push.has_skin_pool != 0 ? skin_rows[instance] : instance;
    const uint of_section = gl_VertexIndex - push.first_vertex;
    const Affine model_from_bind = blended_skin_matrix(push.first_influences, push.influence_sets, of_section,
                                                       skin_row * push.palette_count);
    const vec3 bind_normal = morphed_normal(vertex.position_normal.w, push.morph_count, morphs.normal);
    return ModelVertex(affine_point(model_from_bind, uintBitsToFloat(vertex.position_normal.xyz) + morphs.position),
                       transform_normal(model_from_bind, bind_normal));
}

void main() {
    const uint instance = kListed ? list[kFirstListed + list[kListBegins + push.lod] + gl_InstanceIndex]
                                  : gl_InstanceIndex;
    vec3 color = vec3(1);
    if (kHasLooks) {
        const SectionLook look = look_of_section(instance, push.section, push.section_count);
        if (look.material != push.material) {
            gl_Position = vec4(0, 0, -1, 1);  // outside of the clip volume
            return;
        }
        color = look_color(instance, look);
    }
    const VertexRows vertex = vertices[gl_VertexIndex];
    const ModelVertex model = model_vertex(instance, vertex);
    const Affine placement = world_from_model[instance];
    const vec4 world = vec4(affine_point(placement, model.position), 1);
    out_texcoord = uintBitsToFloat(vertex.texcoord_color_delta.xy);
    out_color = unpackUnorm4x8(vertex.texcoord_color_delta.z) * vec4(color, 1);
    out_layer = coverage_layer(push.first_layer + instance, push.section);
    if (kShadow) {
        // What lies above the map's range casts its shadow from the top of that range
        gl_Position = vec4(2 * dot(scene.map_from_world[0], world) - 1, 2 * dot(scene.map_from_world[1], world) - 1,
                           min(dot(scene.map_from_world[2], world), 1), 1);
    } else {
        const vec3 normal = transform_normal(placement, model.normal);
        out_normal = normal * inversesqrt(max(dot(normal, normal), 1e-30));
        const float volume = dot(placement.row0.xyz, cross(placement.row1.xyz, placement.row2.xyz));
        out_mirrored = volume < 0 ? 1 : 0;
        out_size = max(push.size * pow(abs(volume), 1 / 3.0), 1e-6);
        out_world = world.xyz;
        gl_Position = vec4(dot(scene.clip_from_world[0], world), dot(scene.clip_from_world[1], world),
                           dot(scene.clip_from_world[2], world), dot(scene.clip_from_world[3], world));
    }
}
