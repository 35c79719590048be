// What a kernel is given besides its rig: the buffers of src/fused/fused.glsl.
#pragma once

#include "blend/inertia_io.h"
#include "blend/pose_override_io.h"
#include "control/controller_io.h"
#include "native/kernel_data.h"

namespace throng::native {

struct KernelUpdate {
    const io::InstanceCursor* cursors = nullptr;   // [instance]; or
    const io::ActiveClip* active_clips = nullptr;  // [instance][active_clip_limit]
    uint32_t active_clip_limit = 0;
    const float* masks = nullptr;                      // NativeRig::masks_in_order()
    const io::InstanceInertia* inertias = nullptr;     // [instance], for layers
    float* inertia_states = nullptr;                   // [instance][NativeRig::inertia_floats()]
    const io::InstancePose* pose_overrides = nullptr;  // [instance]
    const float* set_poses = nullptr;                  // [slot][NativeRig::pose_floats()]
    uint32_t skin_format = 0;                          // bind/bind_io.h
    std::byte* skin = nullptr;                         // [instance][palette entry], at a multiple of 16 bytes
    const uint32_t* skin_rows = nullptr;               // [instance]: its row in skin; null: its own number
    float* model = nullptr;                            // [instance][joint of the rig][12], or none
    float* sockets = nullptr;                          // [instance][socket][12]
    std::byte* scratch = nullptr;                      // scratch_bytes() of the kernel, at a multiple of 64
};

struct Kernel {
    uint32_t lane_count;
    size_t (*scratch_bytes)(const KernelRig& rig, const KernelUpdate& update);
    // Walks instances [count] in groups of as many as there are lanes. The skin matrices of all must begin at the same
    // offset in a cache line.
    void (*update)(const KernelRig& rig, const KernelUpdate& update, const uint32_t* instances, uint32_t count);
    // Only what comes before the walk, for benchmarks.
    void (*decode)(const KernelRig& rig, const KernelUpdate& update, const uint32_t* instances, uint32_t count);
    // Streams `size` bytes, a multiple of 64, to a multiple of 64: what memory alone costs.
    void (*fill)(std::byte* to, size_t size);
    void (*fence)();  // makes streamed data visible to other threads
};

}  // namespace throng::native
