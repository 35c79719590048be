#include "draw/native_mesh.h"

#include "draw/native_vertices.h"

#include <algorithm>
#include <cstring>

namespace throng {
namespace {

template <class T>
const T* content(const Buffer& buffer) {
    return reinterpret_cast<const T*>(buffer.mapped());
}

}  // namespace

NativeMesh::NativeMesh(const Group& group, uint32_t lod_count) : section_count_(group.sections.size()) {
    for (uint32_t lod = 0; lod < lod_count; ++lod) {
        for (size_t section = 0; section < section_count_; ++section)
            sections_.push_back(make_section(group, lod, section));
        gather_entries(group, lod);
        uint32_t& vertex_count = vertex_counts_.emplace_back();
        for (size_t section = 0; section < section_count_; ++section)
            if (at(lod, section)) vertex_count += at(lod, section)->section.vertex_count;
    }
}

// Gathers the palette entries that a level uses: coarse levels use few of them.
void NativeMesh::gather_entries(const Group& group, uint32_t lod) {
    const std::span sections = std::span(sections_).subspan(lod * section_count_, section_count_);
    std::vector<bool> is_used(group.palette_count);
    for (const auto& section : sections)
        if (section)
            for (size_t i = 0; i < section->entries_.size(); ++i)
                if (section->weights_[i] != 0) is_used[section->entries_[i]] = true;
    std::vector<uint32_t>& entries = entries_.emplace_back();
    std::vector<uint16_t> places(group.palette_count);
    for (uint32_t entry = 0; entry < group.palette_count; ++entry) {
        places[entry] = static_cast<uint16_t>(entries.size());
        if (is_used[entry]) entries.push_back(entry);
    }
    for (const auto& section : sections)
        if (section)
            for (size_t i = 0; i < section->entries_.size(); ++i)
                section->entries_[i] = section->weights_[i] != 0 ? places[section->entries_[i]] : uint16_t{0};
}

std::unique_ptr<NativeSection> NativeMesh::make_section(const Group& group, uint32_t lod, size_t index) {
    const SectionLod range = group.section_lod(index, lod);
    const uint32_t triangle_count = range.index_count / 3;
    if (triangle_count == 0) return nullptr;
    auto made = std::make_unique<NativeSection>();
    made->of = &group.sections[index];
    made->first_influences = range.first_influences;

    // Vertices in the order in which triangles first use them
    const uint32_t* const indices = content<uint32_t>(group.indices) + range.first_index;
    const size_t padded = whole_blocks(triangle_count);
    std::vector<uint32_t> numbers(made->of->vertex_count, kNone);
    made->corners_.resize(3 * padded);
    for (uint32_t triangle = 0; triangle < triangle_count; ++triangle)
        for (uint32_t corner = 0; corner < 3; ++corner) {
            uint32_t& number = numbers[indices[3 * triangle + corner]];
            if (number == kNone) {
                number = static_cast<uint32_t>(made->sources.size());
                made->sources.push_back(indices[3 * triangle + corner]);
            }
            made->corners_[corner * padded + triangle] = number;
        }
    made->section.triangle_count = triangle_count;
    for (uint32_t corner = 0; corner < 3; ++corner)
        made->section.corners[corner] = made->corners_.data() + corner * padded;
    set_vertices(group, *made);
    return made;
}

void NativeMesh::set_vertices(const Group& group, NativeSection& made) {
    const MeshSection& of = *made.of;
    const size_t count = made.sources.size(), padded = whole_blocks(count);
    const uint32_t sets = of.influence_sets;
    const Vertex* const vertices = content<Vertex>(group[io::kVerticesBuffer]) + of.first_vertex;
    const Influences* const influences = content<Influences>(group[io::kInfluencesBuffer]) + made.first_influences;
    made.bind_ = native::aligned_bytes(padded * kBindFloats * sizeof(float));
    std::memset(made.bind_.get(), 0, padded * kBindFloats * sizeof(float));
    auto* const bind = reinterpret_cast<float*>(made.bind_.get());
    made.weights_.resize(padded * sets * 4);
    made.entries_.resize(padded * sets * 4);
    made.texcoords_.resize(padded * 2);
    made.colors_.resize(padded);
    for (size_t i = 0; i < count; ++i) {
        const uint32_t source = made.sources[i];
        const Vertex& vertex = vertices[source];
        unpack_vertex(vertex, bind + i * kBindFloats);
        for (uint32_t set = 0; set < sets; ++set) {
            const Influences& from = influences[size_t{source} * sets + set];
            std::ranges::copy(from.weights, made.weights_.begin() + static_cast<ptrdiff_t>((i * sets + set) * 4));
            std::ranges::copy(from.entries, made.entries_.begin() + static_cast<ptrdiff_t>((i * sets + set) * 4));
        }
        std::ranges::copy(vertex.texcoord, made.texcoords_.begin() + static_cast<ptrdiff_t>(i * 2));
        made.colors_[i] = vertex.color;
        if (vertex.first_delta > 0 && of.morph_count > 0)
            made.moved.push_back({static_cast<uint32_t>(i), vertex.first_delta, vertex.normal_octahedral});
    }
    raster::Section& section = made.section;
    section.vertex_count = static_cast<uint32_t>(count);
    section.bind = bind;
    section.weights = made.weights_.data();
    section.entries = made.entries_.data();
    section.influence_count = 4 * sets;
    section.texcoords = made.texcoords_.data();
    section.colors = made.colors_.data();
}

}  // namespace throng
