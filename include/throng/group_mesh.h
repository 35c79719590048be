// What a group is drawn from, for an application that draws it by pipelines of its own.
#pragma once

#include <throng/outputs.h>

#include <cstdint>
#include <vector>

namespace throng {

// A section of the mesh in one level of detail, as an indexed draw. Its vertexOffset is MeshSection::first_vertex.
struct SectionLod {
    uint32_t first_index = 0, index_count = 0;  // of GroupMesh::index
    // Index in GroupMesh::influences where those of the section's first vertex begin. Each vertex of the section has
    // MeshSection::influence_sets of them, one vertex after the other
    uint32_t first_influences = 0;
};

// The buffers belong to the crowd, and may be shared with others that have the same character (Crowd::create()). They
// stay as long as the crowd lives, and must not be written. Their contents are valid when the commands of the first
// record(), or of record_uploads(), have run, and are visible to all later commands on the queue. Empty on a native
// device: Character has the same data.
struct GroupMesh {
    BufferView vertex{};      // Vertex[Character::vertices], as storage buffer or vertex buffer
    BufferView influences{};  // Influences, for each set of joints (Culling::reduces_joints); storage or vertex buffer
    // uint32_t: triangles of all levels of detail, relative to the first vertex of their section
    BufferView index{};
    BufferView morph_delta{};  // MorphDelta[Character::morph_deltas], as storage buffer; none where there are no morphs

    uint32_t lod_count = 0;                  // 1 + Character::lods; at most four
    std::vector<SectionLod> section_lods{};  // [section_count][lod_count]
};

}  // namespace throng
