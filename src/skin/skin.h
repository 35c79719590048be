// The skin stage: skin matrices -> vertices of instances.
#pragma once

#include "gpu/kernel.h"
#include "gpu/upload.h"
#include "skin/skin_io.h"

#include <throng/crowd.h>

#include <span>

namespace throng {

// Which vertices of a character a level of detail has.
struct SkinTables {
    SkinTables() = default;
    // Level 0 has all of them, the others those that their triangles have. `influence_offsets`: [1 + details], of each
    // level's influences from the finest's.
    SkinTables(Uploads& uploads, const Character& character, std::span<const uint32_t> influence_offsets);
    uint64_t size_bytes() const { return sections.size_bytes() + vertices.size_bytes(); }

    Buffer sections;  // io::SkinSection[1 + details][section_count]
    Buffer vertices;  // uint[], counted within their section
};

// In the order of the bindings; dispatched with io::SkinPush, a workgroup per instance.
struct SkinBuffers {
    BufferRange vertices;          // Vertex[]
    BufferRange influences;        // Influences[]
    BufferRange skin_matrices;     // [instance_count][palette_count], in the format of the kernel
    BufferRange skinned;           // SkinnedVertex[instance_count][vertex_count], written
    BufferRange morph_deltas;      // MorphDelta[]; where there are none, any buffer
    BufferRange active_morphs;     // io::ActiveMorph[instance_count][kActiveMorphs]; likewise
    BufferRange sections, listed;  // SkinTables
    BufferRange list, verdicts;    // of the cull stage, for kernels that are told what to skin; else any buffer
};

Kernel skin_kernel(const std::shared_ptr<Gpu>& gpu, SkinFormat format, SkinBlend blend, bool listed);

}  // namespace throng
