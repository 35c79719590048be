#include "skin/skin.h"

#include "base/count.h"
#include "skin/skin.kernel.h"

#include <algorithm>
#include <numeric>

namespace throng {
namespace {

static_assert(io::kSkinLinear == static_cast<uint32_t>(SkinBlend::kLinear) &&
              io::kSkinDualQuaternion == static_cast<uint32_t>(SkinBlend::kDualQuaternion));

// The distinct vertices, ascending.
std::vector<uint32_t> vertices_of(std::span<const uint32_t> indices) {
    std::vector<uint32_t> vertices(indices.begin(), indices.end());
    std::ranges::sort(vertices);
    vertices.erase(std::ranges::unique(vertices).begin(), vertices.end());
    return vertices;
}

std::vector<uint32_t> all_of(uint32_t vertex_count) {
    std::vector<uint32_t> vertices(vertex_count);
    std::iota(vertices.begin(), vertices.end(), 0u);
    return vertices;
}

}  // namespace

SkinTables make_skin_tables(const Character& character, std::span<const uint32_t> influence_offsets) {
    SkinTables tables;
    for (size_t lod = 0; lod < influence_offsets.size(); ++lod) {
        for (size_t s = 0; s < character.sections.size(); ++s) {
            const MeshSection& section = character.sections[s];
            std::vector<uint32_t> listed;
            if (lod == 0) {
                listed = all_of(section.vertex_count);
            } else {
                const IndexRange& range = character.lod_ranges[(lod - 1) * character.sections.size() + s];
                listed = vertices_of(std::span(character.lod_indices).subspan(range.first_index, range.index_count));
            }
            tables.sections.push_back({.first_vertex = section.first_vertex,
                                       .first_influences = section.first_influences + influence_offsets[lod],
                                       .influence_sets = section.influence_sets,
                                       .first_morph = section.first_morph,
                                       .morph_count = section.morph_count,
                                       .first_listed = static_cast<uint32_t>(tables.vertices.size()),
                                       .listed_count = lod == 0 ? section.own_vertex_count() : count_of(listed),
                                       .vertex_count = section.vertex_count});
            tables.vertices.insert(tables.vertices.end(), listed.begin(), listed.end());
        }
    }
    return tables;
}

void upload_skin_tables(Uploads& uploads, const Character& character, std::span<const uint32_t> influence_offsets,
                        Buffers& buffers) {
    const SkinTables tables = make_skin_tables(character, influence_offsets);
    buffers[io::kSkinSectionsBuffer] = upload(uploads, character.name + ": sections of levels of detail",
                                              tables.sections);
    buffers[io::kListedVerticesBuffer] = upload(uploads, character.name + ": vertices of levels of detail",
                                                tables.vertices);
}

Kernel skin_kernel(const std::shared_ptr<Gpu>& gpu, SkinFormat format, SkinBlend blend, SkinScope scope) {
    return kernels::skin.on(gpu, {static_cast<uint32_t>(format), static_cast<uint32_t>(blend),
                                  scope == SkinScope::kListed, scope == SkinScope::kAllVertices});
}

}  // namespace throng
