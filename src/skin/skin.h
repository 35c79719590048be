// The skin stage: skin matrices -> vertices of instances.
#pragma once

#include "gpu/kernel.h"
#include "gpu/upload.h"
#include "skin/skin_io.h"

#include <throng/character.h>
#include <throng/skin_format.h>

#include <span>

namespace throng {

// The vertices of each level of detail. Level 0 has its own, and behind them lists those that only coarser levels have;
// coarser levels have those that their triangles use.
// `influence_offsets`: [1 + lods], distance from the finest level's influences to those of each level.
struct SkinTables {
    std::vector<io::SkinSection> sections;  // [level][section]
    std::vector<uint32_t> vertices;         // the lists of all sections, concatenated
};
SkinTables make_skin_tables(const Character& character, std::span<const uint32_t> influence_offsets);

// Fills kSkinSectionsBuffer and kListedVerticesBuffer.
void upload_skin_tables(Uploads& uploads, const Character& character, std::span<const uint32_t> influence_offsets,
                        Buffers& buffers);

enum class SkinScope {
    kFinest,       // level of detail 0 of all instances
    kListed,       // the levels that the cull stage lists instances in
    kAllVertices,  // those of all levels of detail, of all instances
};
// Dispatched with io::SkinPush, a workgroup per instance.
Kernel skin_kernel(const std::shared_ptr<Gpu>& gpu, SkinFormat format, SkinBlend blend, SkinScope scope);

}  // namespace throng
