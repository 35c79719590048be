// The blend stage: two poses of each instance -> its local transforms.
#pragma once

#include "blend/blend_io.h"
#include "gpu/kernel.h"

namespace throng {

// In the order of the bindings; dispatched with io::BlendPush, a workgroup per instance.
struct BlendBuffers {
    BufferRange cursors;       // io::InstanceCursor[instance_count]
    BufferRange first_poses;   // io::JointPose[instance_count][joint_count]
    BufferRange second_poses;  // the same
    // [instance_count][joint_count], parent_from_joint, written: Affine, or Similarity (gpu/similarity.glsl)
    BufferRange local;
    BufferRange posed;  // of poses that may be set: io::InstancePose[instance_count], a table of words; else any
    // Of poses that may be set: io::JointPose[pose_capacity][joint_count], a table of rows; else any
    BufferRange poses;
};

// Similarities, 32 bytes each, only for rigs of uniform scale.
enum class BlendOutput { kAffine, kSimilarity };

struct BlendSettings {
    BlendOutput output = BlendOutput::kAffine;
    bool posed = false;  // poses may be set
};
Kernel blend_kernel(const std::shared_ptr<Gpu>& gpu, const BlendSettings& settings);

}  // namespace throng
