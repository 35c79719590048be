// What the kernels of src/raster do not do with vertices (formats, morphs, dual quaternions), computed by the shaders'
// own source.
#pragma once

#include "crowd/batch.h"
#include "draw/native_mesh.h"

#include <throng/skin_format.h>

namespace throng {

// Position, 1, normal, 0, as raster::Section::bind has them.
void unpack_vertex(const Vertex& vertex, float* bind);

// An instance of a batch, as the buffers have it. `skin()`: the first of its matrices.
struct PosedInstance {
    const Group& group;
    const Batch& batch;
    uint32_t instance = 0;  // of the batch
    const Affine& placement() const { return placements()[instance]; }
    std::byte* skin(SkinFormat format) const;
    // Whether any morph has weight.
    bool is_morphed() const;

private:
    const Affine* placements() const { return reinterpret_cast<const Affine*>(batch[io::kPlacementsBuffer].mapped()); }
};

// Converts the instance's skin matrices of these palette entries from any format.
void unpack_skin_matrices(SkinFormat format, const PosedInstance& of, std::span<const uint32_t> entries,
                          Affine* matrices);
inline constexpr size_t kSimilarity_bytes = 32;
// Converts all its skin matrices to Similarity of gpu/similarity.glsl, 32 bytes each.
void unpack_similarities(SkinFormat format, const PosedInstance& of, std::byte* similarities);

// In bind space: section.bind, with what its morphs add.
void morph_vertices(const PosedInstance& of, const NativeSection& section, float* bind);
// In world space, [vertex_count][8] as Section::bind: blended as dual quaternions; `bind` as morph_vertices() leaves
// it.
void blend_dual_quaternions(const PosedInstance& of, const NativeSection& section, std::byte* similarities,
                            const float* bind, float* world);
// In world space: places the vertices that the crowd's skin stage has skinned.
void place_skinned(const PosedInstance& of, const NativeSection& section, float* world);

}  // namespace throng
