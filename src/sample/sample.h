// The sample stage: one clip of each instance -> the pose of its joints.
#pragma once

#include "sample/sample_io.h"
#include "gpu/kernel.h"

namespace throng {

// In the order of the bindings; dispatched with io::SamplePush, a workgroup per instance.
struct SampleBuffers {
    BufferRange cursors;  // io::InstanceCursor[instance_count]
    BufferRange tracks;   // JointTracks[clip_count + 1][joint_count]; this and the next two are tables (gpu/table.glsl)
    BufferRange keys;     // float4[]
    BufferRange words;    // uint[], of packed keys
    BufferRange poses;    // io::JointPose[instance_count][joint_count], written where the clip has weight
};

// `packed`: Character::packed.
Kernel sample_kernel(const std::shared_ptr<Gpu>& gpu, bool packed);

}  // namespace throng
