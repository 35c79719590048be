// The fused kernel: cursors -> skin matrices in one pass, by one scan method for one character.
#pragma once

#include "fused/fused_io.h"
#include "gpu/kernel.h"
#include "gpu/upload.h"
#include "scan/scan.h"

#include <throng/character.h>
#include <throng/crowd.h>

namespace throng {

// In the order of the bindings.
struct FusedBuffers {
    BufferRange cursors;  // io::InstanceCursor[instance_count]; of layers, any buffer
    BufferRange tracks;   // JointTracks[clip_count + 1][joint_count]; all tables (gpu/table.glsl) up to `binds`
    BufferRange keys;     // float4[]
    BufferRange words;    // uint[], of packed keys
    BufferRange links;    // FusedTables
    BufferRange bind_ranges, bind_entries, binds;
    BufferRange skin;  // [instance_count][palette_count] in FusedSettings::skin_format, model_from_bind, written
    // Affine[instance_count][joint_count], model_from_joint, written where FusedSettings::keeps_model; else any buffer
    BufferRange model;
    BufferRange voices;  // of layers: io::Voice[instance_count][voice_limit]; else any table of rows
    BufferRange masks;   // of layers: float[mask_count][joint_count]; else any table of words
    // Of sockets: uint[joint_count], 1 + the joint's place in the next, or 0; else any table of words
    BufferRange socket_slots;
    // Of sockets: Affine[instance_count][socket_count], model_from_joint, written; else any buffer
    BufferRange sockets;
    BufferRange inertias;  // of inertial transitions: io::InstanceInertia[instance_count]; else any buffer
    // Of inertial transitions: io::InertiaState[instance_count][joint_count], read and written; else any buffer
    BufferRange inertia_states;
    BufferRange posed;  // of poses that may be set: io::InstancePose[instance_count], a table of words; else any
    // Of poses that may be set: io::JointPose[pose_capacity][joint_count], a table of rows; else any
    BufferRange poses;
    BufferRange work;        // of listed instances (cull/cull_io.h), a table of words; else any
    BufferRange rig_joints;  // of a part of the joints: FusedTables'; else any table of words
};

struct FusedSettings {
    bool packed = false;  // Character::packed
    bool blends = true;   // false: no instance has two clips with weight
    bool keeps_model = false;
    SkinFormat skin_format = SkinFormat::kAffine;
    bool layered = false;  // instances play voices, not the two clips of cursors
    uint32_t socket_count = 0;
    bool inertial = false;     // layered, with inertial transitions
    bool posed = false;        // poses may be set
    bool listed = false;       // only instances of a section of the work are animated
    bool some_joints = false;  // not all joints are
};

// What of a character decides how it is fused: of all its joints, or of those of a coarser level of detail.
struct FusedRig {
    explicit FusedRig(const Character& character, uint32_t detail = 0);

    ScanRig rig;
    std::vector<uint32_t> rig_joints;  // [joint_count], the character's
    std::vector<bool> fixed;           // [joint_count], fused/fixed_joints.h
    uint32_t palette_count = 0;
    uint32_t most_binds = 0;  // palette entries of one joint
};

// How a scan method goes about a character in one pass.
struct FusedPlan {
    std::string obstacle;  // why it does not; empty where it does
    ScanChoice choice;
    ScanPlan scan;
    uint32_t tile_transforms = 0;  // local transforms that pass through shared memory together; 0: none do
    bool one_bind = false;         // no joint has two palette entries
};

FusedPlan plan_fused(const ScanChoice& choice, const FusedRig& rig, const ScanLimits& limits);

// For a device: the first plan without obstacle of those that are likely best, or the last one's obstacle.
FusedPlan choose_fused(const FusedRig& rig, const ScanLimits& limits);

// What the kernel reads of a character beside its clips.
struct FusedTables {
    FusedTables(Uploads& uploads, const Character& character, const FusedRig& rig, const FusedPlan& plan);

    Buffer links;         // of the plan
    Buffer bind_ranges;   // uint[joint_count + 1]: where a joint's palette entries begin in the next two
    Buffer bind_entries;  // uint[palette_count], palette entries of these joints, sorted by joint
    Buffer binds;         // Affine[palette_count], joint_from_bind of these
    Buffer rig_joints;    // FusedRig's

    uint64_t size_bytes() const {
        return links.size_bytes() + bind_ranges.size_bytes() + bind_entries.size_bytes() + binds.size_bytes() +
               rig_joints.size_bytes();
    }
};

Kernel fused_kernel(const std::shared_ptr<Gpu>& gpu, const FusedPlan& plan, const FusedSettings& settings);

// Of all instances.
void record_fused(VkCommandBuffer commands, const Kernel& kernel, const Bindings& bindings, const FusedPlan& plan,
                  const io::FusedPush& push);

}  // namespace throng
