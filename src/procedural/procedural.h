// The procedural stage: local transforms of chosen joints -> the same joints, moved by rules (docs/procedural.md).
#pragma once

#include "gpu/kernel.h"
#include "procedural/procedural_io.h"

namespace throng {

// In the order of the bindings; dispatched with io::ProceduralPush, push.workgroups workgroups for each chain.
struct ProceduralBuffers {
    BufferRange tables;      // words (procedural_tables.h), a table
    BufferRange placements;  // Affine[instance_count], world_from_model
    BufferRange targets;     // float4[instance_count][target_count], world; w: weight, 0..1
    // io::SpringState[instance_count][spring_count], read and written; zero before the first update
    BufferRange springs;
    // [instance_count][joint_count], parent_from_joint, read and written: Affine, or Similarity (gpu/similarity.glsl)
    BufferRange local;
};

// For chains of one kind.
Kernel procedural_kernel(const std::shared_ptr<Gpu>& gpu, uint32_t kind, bool similarities);

}  // namespace throng
