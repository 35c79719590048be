// Whole updates of characters on the CPU: sample, blend, scan and bind in one pass, with the widest vectors that the
// machine has. What src/fused does on a device; defined by the same references. No Vulkan.
#pragma once

#include "native/kernel_update.h"
#include "native/native_rig.h"

#include <span>
#include <string>
#include <string_view>

namespace throng {

enum class NativeIsa : uint8_t { kSse2, kAvx2, kAvx512, kNeon };

std::string_view name_of(NativeIsa isa);
// The instruction sets that this program was compiled for and that the machine has, slowest first. Never empty on
// x86-64 and AArch64.
std::span<const NativeIsa> native_isas();

// Why the native engine cannot update the character in this format; empty if it can.
std::string native_unsupported_reason(const Character& character, SkinFormat skin_format);

// Where an update reads and writes. docs/buffers.md describes the buffers; as there, cursors and active clips are those
// of the control stage. Masks, inertia states and set poses begin at a multiple of 64 bytes.
struct NativeUpdate {
    const io::InstanceCursor* cursors = nullptr;   // two clips each; not used with active_clips
    const io::ActiveClip* active_clips = nullptr;  // in layers; the lowest covers all (docs/controller.md, step 9)
    uint32_t active_clip_limit = 0;
    const float* masks = nullptr;                   // NativeRig::masks_in_order()
    const io::InstanceInertia* inertias = nullptr;  // for layers with inertial transitions
    float* inertia_states = nullptr;                // [instance][NativeRig::inertia_floats()], zeros at first
    const io::InstancePose* pose_overrides = nullptr;
    const float* set_poses = nullptr;  // [slot][NativeRig::pose_floats()], by put_pose()
    SkinFormat skin_format = SkinFormat::kAffine;
    std::byte* skin = nullptr;            // at a multiple of 64 bytes
    const uint32_t* skin_rows = nullptr;  // each instance's row in skin; null: in the order of the instances
    Affine* model = nullptr;              // if the rig keeps them
    Affine* sockets = nullptr;            // if the rig has any; model_from_joint
    const uint32_t* listed = nullptr;     // instances to update; null: all
};

// Updates instances first..end - 1, or those at these places of `listed`. Threads may update different instances of the
// same buffers at the same time. An instance's result does not depend on which others are updated with it. Allocates
// only in a thread's first updates: scratch memory, as much as its largest rig needs.
void update(const NativeRig& rig, const NativeUpdate& update, uint32_t first, uint32_t end, NativeIsa isa);
void update(const NativeRig& rig, const NativeUpdate& update, uint32_t first, uint32_t end);

// How many consecutive instances update() needs to fill its lanes. It computes instances side by side if their matrices
// begin at the same offset in a cache line.
uint32_t min_part(const NativeRig& rig, SkinFormat skin_format);

// For comparison with an update (bench/cpu_bench.h): its first half alone, and the least time that writing memory
// takes. `bytes` begin and end at a multiple of 64.
void decode_only(const NativeRig& rig, const NativeUpdate& update, uint32_t first, uint32_t end, NativeIsa isa);
void stream_fill(std::span<std::byte> bytes, NativeIsa isa);

}  // namespace throng
