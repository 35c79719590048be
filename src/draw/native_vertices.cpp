#include "draw/native_vertices.h"

#include "bind/bind_io.h"
#include "gpu/native_text.h"
#include "morph/morph_io.h"
#include "skin/skin_io.h"

#include <algorithm>
#include <array>
#include <bit>

namespace throng {
namespace io {
namespace {

// What character.vert includes, and the buffers that it declares.
struct VertexText : NativeText {
    explicit VertexText(const NativeDispatch& of, SkinFormat format = SkinFormat::kAffine,
                        SkinBlend blend = SkinBlend::kLinear)
        : NativeText(of, 0, 1, 0), kSkinFormat(static_cast<uint>(format)), kSkinBlend(static_cast<uint>(blend)) {}

    const uint kSkinFormat, kSkinBlend;
    READONLY_BUFFER(kInfluencesBuffer, uvec2, influences);
    READONLY_BUFFER(kMorphDeltasBuffer, uvec4, morph_deltas);
    READONLY_BUFFER(kActiveMorphsBuffer, ActiveMorph, active_morphs);

#include "bind/skin_format.glsl"
#include "skin/skin.glsl"
#include "skin/normal.glsl"
#include "morph/apply.glsl"

    // Writes a vertex in world space, placed as character.vert does it.
    void place(const Affine& placement, const vec3& position, const vec3& normal, float* world) {
        set_vertex(affine_point(placement, position), transform_normal(placement, normal), world);
    }
    static void set_vertex(const vec3& position, const vec3& normal, float* vertex) {
        const std::array numbers{position.x, position.y, position.z, 1.0f, normal.x, normal.y, normal.z, 0.0f};
        std::ranges::copy(numbers, vertex);
    }
    static vec3 position_of(const float* vertex) { return {vertex[0], vertex[1], vertex[2]}; }
    static vec3 normal_of(const float* vertex) { return {vertex[4], vertex[5], vertex[6]}; }
};

}  // namespace
}  // namespace io

using io::VertexText;

std::byte* PosedInstance::skin(SkinFormat format) const {
    return batch.skin().mapped() +
           size_t{skin_row_of(group, batch, instance)} * group.palette_count * skin_format_bytes(format);
}

bool PosedInstance::is_morphed() const {
    const Buffer& active = batch[io::kActiveMorphsBuffer];
    if (group.morph_count == 0 || !active) return false;
    // Morphs that have weight come first
    return reinterpret_cast<const io::ActiveMorph*>(active.mapped())[size_t{instance} * group.active_morph_limit]
               .weight != 0;
}

void unpack_vertex(const Vertex& vertex, float* bind) {
    const NativeDispatch none;
    VertexText text(none);
    text.set_vertex(io::copied<io::vec3>(&vertex.position), text.unpack_normal(vertex.normal_octahedral), bind);
}

void unpack_skin_matrices(SkinFormat format, const PosedInstance& of, std::span<const uint32_t> entries,
                          Affine* matrices) {
    NativeDispatch buffers;
    buffers.buffers[io::kSkinBuffer] = of.skin(format);
    VertexText text(buffers, format);
    for (const uint32_t entry : entries) *matrices++ = std::bit_cast<Affine>(text.load_skin(entry));
}

void unpack_similarities(SkinFormat format, const PosedInstance& of, std::byte* similarities) {
    NativeDispatch buffers;
    buffers.buffers[io::kSkinBuffer] = of.skin(format);
    VertexText text(buffers, format);
    for (uint32_t i = 0; i < of.group.palette_count; ++i) {
        const io::Similarity similarity = text.load_skin_similarity(i);
        static_assert(sizeof similarity == kSimilarity_bytes);
        std::memcpy(similarities + i * sizeof similarity, &similarity, sizeof similarity);
    }
}

void morph_vertices(const PosedInstance& of, const NativeSection& section, float* bind) {
    const raster::Section& all = section.section;
    std::copy_n(all.bind, whole_blocks(all.vertex_count) * kBindFloats, bind);
    NativeDispatch buffers;
    buffers.buffers[io::kMorphDeltasBuffer] = of.group[io::kMorphDeltasBuffer].mapped();
    buffers.buffers[io::kActiveMorphsBuffer] = of.batch[io::kActiveMorphsBuffer].mapped();
    VertexText text(buffers);
    const MeshSection& mesh = *section.of;
    for (const auto& [vertex, first_delta, packed_normal] : section.moved) {
        const VertexText::MorphSum morphs = text.sum_of_morphs(first_delta, mesh.first_morph, mesh.morph_count,
                                                               of.instance, of.group.active_morph_limit);
        float* const moved = bind + size_t{vertex} * kBindFloats;
        text.set_vertex(text.position_of(moved) + morphs.position,
                        text.morphed_normal(packed_normal, mesh.morph_count, morphs.normal), moved);
    }
}

void blend_dual_quaternions(const PosedInstance& of, const NativeSection& section, std::byte* similarities,
                            const float* bind, float* world) {
    NativeDispatch buffers;
    buffers.buffers[io::kSkinBuffer] = similarities;
    buffers.buffers[io::kInfluencesBuffer] = of.group[io::kInfluencesBuffer].mapped();
    VertexText text(buffers, SkinFormat::kSimilarity, SkinBlend::kDualQuaternion);
    const auto placement = std::bit_cast<io::Affine>(of.placement());
    for (size_t i = 0; i < section.sources.size(); ++i) {
        const float* const vertex = bind + i * kBindFloats;
        const io::Affine model_from_bind = text.blended_skin_matrix(section.first_influences,
                                                                    section.of->influence_sets, section.sources[i], 0);
        text.place(placement, io::affine_point(model_from_bind, text.position_of(vertex)),
                   text.transform_normal(model_from_bind, text.normal_of(vertex)), world + i * kBindFloats);
    }
}

void place_skinned(const PosedInstance& of, const NativeSection& section, float* world) {
    const NativeDispatch none;
    VertexText text(none);
    const auto placement = std::bit_cast<io::Affine>(of.placement());
    const auto* const skinned = reinterpret_cast<const SkinnedVertex*>(
                                    of.batch.shown_in(of.batch.slot, io::kSkinnedBuffer).mapped()) +
                                size_t{of.instance} * of.group.vertex_count + section.of->first_vertex;
    for (size_t i = 0; i < section.sources.size(); ++i) {
        const SkinnedVertex& vertex = skinned[section.sources[i]];
        text.place(placement, io::copied<io::vec3>(&vertex.position), text.unpack_normal(vertex.normal_octahedral),
                   world + i * kBindFloats);
    }
}

}  // namespace throng
