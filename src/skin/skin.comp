// skin: morphs and skins the vertices of instances, in model space, for use by several passes or for reading back. One
// workgroup per instance. Cost per vertex: 4 + 32 bytes read; for each four influences 24 bytes and their skin
// matrices, which are mostly in caches; 16 bytes written.
#include "gpu/buffers_io.h"
#include "bind/bind_io.h"
#include "cull/cull_io.h"
#include "morph/morph_io.h"
#include "skin/skin_io.h"

WORKGROUP_OF_STRIDE(kSkinWorkgroupSize);
CONSTANT(1, uint, kSkinFormat, kSkinAffine);
CONSTANT(2, uint, kSkinBlend, kSkinLinear);
CONSTANT(3, bool, kListed, false);  // only listed instances are skinned
// Also those that only coarser levels of detail have; instances are not listed then.
CONSTANT(4, bool, kAllVertices, false);
READONLY_BUFFER(kVerticesBuffer, VertexRows, vertices);
READONLY_BUFFER(kInfluencesBuffer, uvec2, influences);
// [instance][vertex], throng::SkinnedVertex
WRITEONLY_BUFFER(kSkinnedBuffer, uvec4, skinned);
READONLY_BUFFER(kMorphDeltasBuffer, uvec4, morph_deltas);
READONLY_BUFFER(kActiveMorphsBuffer, ActiveMorph, active_morphs);
READONLY_BUFFER(kSkinSectionsBuffer, SkinSection, sections);  // [detail][section]
READONLY_BUFFER(kListedVerticesBuffer, uint, listed_vertices);
READONLY_BUFFER(kListBuffer, uint, list);  // cull/cull_io.h
READONLY_BUFFER(kVerdictsBuffer, uint, verdicts);
READONLY_BUFFER(kSkinRowsBuffer, uint, skin_rows);
PUSH(SkinPush);

#include "bind/skin_format.glsl"
#include "skin/skin.glsl"
#include "skin/normal.glsl"
#include "morph/apply.glsl"

// Level of detail of the n-th listed instance.
uint lod_of(uint n) {
    uint lod = 0;
    for (uint k = 1; k < kLodCount; ++k)
        if (n >= list[kListBegins + k]) lod = k;
    return lod;
}

void main() {
    const uint n = gl_WorkGroupID.x;
    const uint instance = kListed ? list[kFirstListed + n] : push.first_instance + n;
    if (kListed && push.only_animated != 0 && (verdicts[instance] & kVerdictAnimated) == 0) return;
    const uint first_section = kListed ? lod_of(n) * push.section_count : 0;
    const uint skin_row = push.has_skin_pool != 0 ? skin_rows[instance] : instance;
    const uint first_written = (kListed ? instance : n) * push.vertex_count;
    for (uint s = 0; s < push.section_count; ++s) {
        const SkinSection section = sections[first_section + s];
        const uint count = kAllVertices ? section.vertex_count : section.listed_count;
        for (uint i = gl_LocalInvocationID.x; i < count; i += kStride) {
            const uint vertex = listed_vertices[section.first_listed + i];
            const VertexRows rows = vertices[section.first_vertex + vertex];
            const MorphSum morphs = sum_of_morphs(rows.texcoord_color_delta.w, section.first_morph, section.morph_count,
                                                  instance, push.active_morph_limit);
            const Affine model_from_bind = blended_skin_matrix(section.first_influences + push.influence_offset,
                                                               section.influence_sets, vertex,
                                                               skin_row * push.palette_count);
            const vec3 position = affine_point(model_from_bind,
                                               uintBitsToFloat(rows.position_normal.xyz) + morphs.position);
            const vec3 normal = transform_normal(
                model_from_bind, morphed_normal(rows.position_normal.w, section.morph_count, morphs.normal));
            skinned[first_written + section.first_vertex + vertex] = uvec4(floatBitsToUint(position),
                                                                           pack_normal(normal));
        }
    }
}
