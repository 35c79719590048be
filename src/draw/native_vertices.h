// The vertex work that the kernels of src/raster leave out (formats, morphs, dual quaternions), computed by the
// shaders' own source.
#pragma once

#include "crowd/batch.h"
#include "draw/native_mesh.h"

#include <throng/skin_format.h>

namespace throng {

// Writes position, 1, normal, 0: the layout of raster::Section::bind.
void unpack_vertex(const Vertex& vertex, float* bind);

// An instance of a batch, with its data in the buffers. `skin()`: the first of its matrices.
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

// Writes section.bind with the offsets of its morphs added, in bind space.
void morph_vertices(const PosedInstance& of, const NativeSection& section, float* bind);
// Blends as dual quaternions. Writes world-space vertices, [vertex_count][8], laid out as Section::bind. `bind`:
// section.bind, or what morph_vertices() has written.
void blend_dual_quaternions(const PosedInstance& of, const NativeSection& section, std::byte* similarities,
                            const float* bind, float* world);
// Places the vertices that the crowd's skin stage has skinned, and writes them in world space.
void place_skinned(const PosedInstance& of, const NativeSection& section, float* world);

}  // namespace throng
