// The skin stage: skin matrices -> positions of one section of one instance.
#pragma once

#include "skin/skin_io.h"
#include "gpu/kernel.h"

#include <throng/crowd.h>

namespace throng {

// In the order of the bindings; dispatched with io::SkinPush, an invocation per vertex.
struct SkinBuffers {
    BufferRange vertices;  // Vertex[]
    BufferRange influences;  // Influences[]
    BufferRange skin_matrices;  // Affine[instance_count][palette_count]
    BufferRange positions;  // float4[], model space, written in the order of vertices
    BufferRange morph_deltas;  // MorphDelta[]; where there are none, any buffer
    BufferRange active_morphs;  // io::ActiveMorph[instance_count][kActiveMorphs]; likewise
};

// `format`: of the skin matrices.
Kernel skin_kernel(const std::shared_ptr<Gpu>& gpu, SkinFormat format);

}  // namespace throng
