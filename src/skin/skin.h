// The skin stage: skin matrices -> vertices of instances.
#pragma once

#include "gpu/kernel.h"
#include "gpu/upload.h"
#include "skin/skin_io.h"

#include <throng/character.h>
#include <throng/skin_format.h>

#include <span>

namespace throng {

// Which vertices of a character each level of detail has. Level 0 has all of them, the others those that their
// triangles use. `influence_offsets`: [1 + lods], how far each level's influences lie behind the finest's.
struct SkinTables {
    std::vector<io::SkinSection> sections;  // [level][section]
    std::vector<uint32_t> vertices;         // those that sections list
};
SkinTables make_skin_tables(const Character& character, std::span<const uint32_t> influence_offsets);

// Fills kSkinSectionsBuffer and kListedVerticesBuffer.
void upload_skin_tables(Uploads& uploads, const Character& character, std::span<const uint32_t> influence_offsets,
                        Buffers& buffers);

// Dispatched with io::SkinPush, a workgroup per instance. `listed`: only instances that the cull stage lists.
Kernel skin_kernel(const std::shared_ptr<Gpu>& gpu, SkinFormat format, SkinBlend blend, bool listed);

}  // namespace throng
