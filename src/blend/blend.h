// The blend stage: two poses of each instance -> its local transforms.
#pragma once

#include "blend/blend_io.h"
#include "gpu/kernel.h"

namespace throng {

// In the order of the bindings; dispatched with io::BlendPush, a workgroup per instance.
struct BlendBuffers {
    BufferRange cursors;  // io::InstanceCursor[instance_count]
    BufferRange first_poses;  // io::JointPose[instance_count][joint_count]
    BufferRange second_poses;  // the same
    BufferRange local;  // [instance_count][joint_count], parent_from_joint, written: Affine, or Similarity (gpu/similarity.glsl)
};

// Similarities, 32 bytes each, only for rigs of uniform scale.
enum class BlendOutput { kAffine, kSimilarity };

Kernel blend_kernel(const std::shared_ptr<Gpu>& gpu, BlendOutput output);

}  // namespace throng
