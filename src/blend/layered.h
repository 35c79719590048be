// The layered stage: the voices of each instance -> its local transforms; sample and blend in one, for characters that
// play in layers.
#pragma once

#include "blend/blend.h"
#include "blend/layered_io.h"
#include "control/controller_io.h"

#include <compare>

namespace throng {

// In the order of the bindings; dispatched with io::LayeredPush, a workgroup per instance. All up to `words` are tables
// (gpu/table.glsl); that of the voices, which a kernel writes, is made by make_table().
struct LayeredBuffers {
    BufferRange voices;  // io::Voice[instance_count][voice_limit]; what lies behind an instance's last one is not read
    BufferRange masks;   // float[mask_count][joint_count], 0..1
    BufferRange tracks;  // JointTracks[clip_count + 1][joint_count]
    BufferRange keys;    // float4[]
    BufferRange words;   // uint[], of packed keys
    // [instance_count][joint_count], parent_from_joint, written: Affine, or Similarity (gpu/similarity.glsl)
    BufferRange local;
    BufferRange inertias;  // of inertial transitions: io::InstanceInertia[instance_count]; else any buffer
    // Of inertial transitions: io::InertiaState[instance_count][joint_count], read and written; else any buffer
    BufferRange inertia_states;
    BufferRange posed;  // of poses that may be set: io::InstancePose[instance_count], a table of words; else any
    // Of poses that may be set: io::JointPose[pose_capacity][joint_count], a table of rows; else any
    BufferRange poses;
    BufferRange parents = {};  // in order: uint[joint_count], io::kAbsent where there is none, a table of words
    // In order: io::ModelRotations[layers in model space][joint_count][instance_count], between joints; its contents do
    // not matter before and after
    BufferRange rotations = {};
};

struct LayeredSettings {
    bool packed = false;  // Character::packed
    BlendOutput output = BlendOutput::kAffine;
    bool inertial = false;
    bool posed = false;  // poses may be set
    // Layers blend rotations in model space: an invocation per instance, and record_layered_in_order()
    bool in_order = false;

    friend auto operator<=>(const LayeredSettings&, const LayeredSettings&) = default;
};
Kernel layered_kernel(const std::shared_ptr<Gpu>& gpu, const LayeredSettings& settings);

// All joints, in as few dispatches as loops of `loop_iterations` (ScanLimits) allow, with barriers between them.
void record_layered_in_order(const Gpu& gpu, VkCommandBuffer commands, const Kernel& kernel, const Bindings& bindings,
                             io::LayeredInOrderPush push, uint32_t loop_iterations);

}  // namespace throng
