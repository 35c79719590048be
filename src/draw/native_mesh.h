// The mesh of a group as the native renderer draws it.
#pragma once

#include "crowd/group.h"
#include "native/aligned.h"
#include "raster/frame.h"

#include <memory>
#include <span>
#include <vector>

namespace throng {

// Floats of a vertex in raster::Section::bind
inline constexpr size_t kBindFloats = 8;
inline size_t whole_blocks(size_t count) { return (count + raster::kBlock - 1) / raster::kBlock * raster::kBlock; }

// A section at one level of detail, with the vertices that this level has.
struct NativeSection {
    raster::Section section;
    const MeshSection* of = nullptr;
    uint32_t first_influences = 0;                    // of the level, in Influences
    std::vector<uint32_t> sources;                    // [vertex_count], vertices of the group's section
    struct Moved {                                    // a vertex that morphs move
        uint32_t vertex = 0;                          // of this section
        uint32_t first_delta = 0, packed_normal = 0;  // Vertex's
    };
    std::vector<Moved> moved;

private:
    friend class NativeMesh;
    std::vector<uint32_t> corners_, colors_;
    native::AlignedBytes bind_;
    std::vector<float> weights_, texcoords_;
    std::vector<uint16_t> entries_;
};

class NativeMesh {
public:
    // Holds the levels of detail 0..lod_count - 1.
    NativeMesh(const Group& group, uint32_t lod_count);

    size_t section_count() const { return section_count_; }
    uint32_t lod_count() const { return static_cast<uint32_t>(entries_.size()); }
    uint32_t vertex_count(uint32_t lod) const { return vertex_counts_[lod]; }
    // Palette entries that a level of detail refers to, ascending; raster::Section::entries are places among these.
    std::span<const uint32_t> entries(uint32_t lod) const { return entries_[lod]; }
    // Null if the level has no triangles of the section.
    const NativeSection* at(uint32_t lod, size_t section) const {
        return sections_[lod * section_count_ + section].get();
    }

private:
    static std::unique_ptr<NativeSection> make_section(const Group& group, uint32_t lod, size_t section);
    static void set_vertices(const Group& group, NativeSection& section);
    void gather_entries(const Group& group, uint32_t lod);

    size_t section_count_ = 0;
    std::vector<std::unique_ptr<NativeSection>> sections_;  // [lod][section]
    std::vector<std::vector<uint32_t>> entries_;            // [lod]
    std::vector<uint32_t> vertex_counts_;                   // [lod], of all sections
};

}  // namespace throng
