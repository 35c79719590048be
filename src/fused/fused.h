// The fused kernel: cursors -> skin matrices in one pass, with one scan method for one character.
#pragma once

#include "fused/fused_io.h"
#include "gpu/kernel.h"
#include "gpu/upload.h"
#include "scan/scan.h"

#include <throng/character.h>
#include <throng/skin_format.h>

namespace throng {

// Constants of the rows (fused/rows_io.h) that a kernel reads in place of keys.
struct FusedRows {
    uint32_t joint_count = 0;    // joints that have columns; 0: the kernel reads keys
    bool other_columns = false;  // kRowColumnsBuffer tells each joint's column
    uint32_t fine_rotation_count = 0, motion_count = 0, fine_motion_count = 0;
    bool plain_entries = false;  // all walked matrices are skin matrices already
};

// With rows, the walked matrices are nearly skin matrices. These are the remaining factors, for each palette entry.
struct FusedBinds {
    std::vector<Affine> matrices;
    std::vector<bool> is_plain;  // the factor is the identity: the walked matrix is the skin matrix
};

struct FusedSettings {
    bool packed = false;  // Character::packed
    bool blends = true;   // false: no instance has two clips with weight
    bool keeps_model = false;
    SkinFormat skin_format = SkinFormat::kAffine;
    bool layered = false;  // instances play active clips, not the two clips of cursors
    uint32_t socket_count = 0;
    bool inertial = false;        // layered, with inertial transitions
    bool pose_overrides = false;  // the application may set poses
    bool listed = false;          // only instances in a section of the work list are animated
    bool maps_joints = false;     // only some joints are animated, or in another order
    bool skin_pool = false;       // kSkinRowsBuffer tells where skin matrices lie
    FusedRows rows{};
};

// The properties of a character that a fused plan depends on; with all joints, or those of a coarser level of detail.
struct FusedRig {
    explicit FusedRig(const Character& character, uint32_t lod = 0);
    // With joints in the order of `stream`'s chunks, so that the lanes of a chunk read adjacent data. (plan_stream()
    // breaks ties by joint order, so a plan made for the new order may have different chunks.)
    FusedRig in_stream_order(uint32_t lanes) const;

    ScanRig rig;
    std::vector<uint32_t> rig_joints;  // [joint_count], indices in the character
    std::vector<bool> fixed;           // [joint_count], fused/fixed_joints.h
    uint32_t palette_count = 0;
    uint32_t max_binds = 0;  // most palette entries of one joint
};

// How a scan method runs fused for a character.
struct FusedPlan {
    std::string unsupported_reason;  // why the method does not apply; empty if it does
    ScanChoice choice;
    ScanPlan scan;
    uint32_t tile_transforms = 0;  // local transforms of a workgroup's tile in shared memory; 0: no tile
    bool one_bind = false;         // no joint has two palette entries
    // The kernel's loops, like ScanCounts::loops, for packed clips, one or two of which are blended, and at most one
    // palette entry per joint; other kernels have more loops.
    std::vector<LoopTrips> loops;
};

FusedPlan plan_fused(const ScanChoice& choice, const FusedRig& rig, const ScanLimits& limits);

// Tries plans in the order in which they are likely to be fast. Returns the first one that applies, or why the last one
// does not. `subgroups_a_character`: subgroups that the device can hold at once, per character.
FusedPlan choose_fused(const FusedRig& rig, const ScanLimits& limits, double subgroups_a_character = 0);

// Uploads the data of a character that the kernel reads besides its clips: kScanLinksBuffer of the plan,
// kBindRangesBuffer, kBindEntriesBuffer, kBindsBuffer and kAnimatedJointsBuffer of the rig's joints. `binds`: for
// kernels that read rows; null: uses the character's inverse binds.
Buffers upload_fused_tables(Uploads& uploads, const Character& character, const FusedRig& rig, const FusedPlan& plan,
                            const FusedBinds* binds = nullptr);

Kernel fused_kernel(const std::shared_ptr<Gpu>& gpu, const FusedPlan& plan, const FusedSettings& settings);

// For all instances.
void record_fused(VkCommandBuffer commands, const Kernel& kernel, const Bindings& bindings, const FusedPlan& plan,
                  const io::FusedPush& push);

}  // namespace throng
