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
// Those that this program was compiled for and that the machine has, the slowest first. Never empty on x86-64 and
// AArch64.
std::span<const NativeIsa> native_isas();

// What a group of characters asks of its updates.
struct NativeNeeds {
    SkinFormat skin_format = SkinFormat::kAffine;
    bool model_rotations = false;  // a layer blends rotations in model space
    bool procedural_rules = false;
};
// Why its updates cannot be these; empty where they can.
std::string native_unsupported(const Character& character, const NativeNeeds& needs);

// Where an update reads and writes; what each buffer has is in docs/buffers.md, and as there cursors and active clips
// are those of the control stage. Masks, states of inertia and set poses begin at a multiple of 64 bytes.
struct NativeUpdate {
    const io::InstanceCursor* cursors = nullptr;   // two clips each; or
    const io::ActiveClip* active_clips = nullptr;  // layers of them; the lowest covers (docs/controller.md, step 9)
    uint32_t active_clip_limit = 0;
    const float* masks = nullptr;                   // NativeRig::masks_in_order()
    const io::InstanceInertia* inertias = nullptr;  // of layers with inertial transitions
    float* inertia_states = nullptr;                // [instance][NativeRig::inertia_floats()], zeros at first
    const io::InstancePose* pose_overrides = nullptr;
    const float* set_poses = nullptr;  // [slot][NativeRig::pose_floats()], by put_pose()
    SkinFormat skin_format = SkinFormat::kAffine;
    std::byte* skin = nullptr;            // at a multiple of 64 bytes
    const uint32_t* skin_rows = nullptr;  // where an instance's matrices lie; none: in the order of the instances
    Affine* model = nullptr;              // of rigs that keep them
    Affine* sockets = nullptr;            // of rigs that have any; model_from_joint
    const uint32_t* listed = nullptr;     // instances; none: all
};

// Instances first..end - 1, or those that `listed` has there. Threads may update different instances of the same
// buffers at a time. An instance's result does not depend on the others updated with it. Allocates nothing but, at a
// thread's first updates, what the walk of the largest rig keeps.
void update(const NativeRig& rig, const NativeUpdate& update, uint32_t first, uint32_t end, NativeIsa isa);
void update(const NativeRig& rig, const NativeUpdate& update, uint32_t first, uint32_t end);

// What an update is compared with (bench/cpu_bench.h): its first half alone, and the least that memory takes for bytes
// that begin and end at a multiple of 64.
void decode_only(const NativeRig& rig, const NativeUpdate& update, uint32_t first, uint32_t end, NativeIsa isa);
void stream_fill(std::span<std::byte> bytes, NativeIsa isa);

}  // namespace throng
