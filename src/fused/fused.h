// The fused kernel: cursors -> skin matrices in one pass, by one scan method for one character.
#pragma once

#include "fused/fused_io.h"
#include "gpu/kernel.h"
#include "gpu/upload.h"
#include "scan/scan.h"

#include <throng/character.h>
#include <throng/skin_format.h>

namespace throng {

// What a kernel must know of the rows (fused/rows_io.h) that it reads in place of keys.
struct FusedRows {
    uint32_t joint_count = 0;    // joints that have columns; 0: keys are read
    bool other_columns = false;  // kRowColumnsBuffer says which
    uint32_t fine_rotation_count = 0, motion_count = 0, fine_motion_count = 0;
    bool plain_entries = false;  // the walked matrices are the skin matrices
};

// With rows, the joints' matrices are nearly skin matrices. This is what is left to multiply them by, for each palette
// entry.
struct FusedBinds {
    std::vector<Affine> matrices;
    std::vector<bool> is_plain;  // the identity: the joint's matrix is the skin matrix
};

struct FusedSettings {
    bool packed = false;  // Character::packed
    bool blends = true;   // false: no instance has two clips with weight
    bool keeps_model = false;
    SkinFormat skin_format = SkinFormat::kAffine;
    bool layered = false;  // instances play active clips, not the two clips of cursors
    uint32_t socket_count = 0;
    bool inertial = false;        // layered, with inertial transitions
    bool pose_overrides = false;  // poses may be set
    bool listed = false;          // only instances of a section of the work are animated
    bool maps_joints = false;     // only some joints are animated, or in another order
    bool skin_pool = false;       // skin matrices lie where kSkinRowsBuffer says
    FusedRows rows{};
};

// What decides how a character is fused: with all its joints, or with those of a coarser level of detail.
struct FusedRig {
    explicit FusedRig(const Character& character, uint32_t lod = 0);
    // With joints in the order of `stream`'s chunks, so that what the lanes of a chunk read lies side by side. (Where
    // joints are equally urgent a plan takes the first, so a plan of the new order may form other chunks.)
    FusedRig in_stream_order(uint32_t lanes) const;

    ScanRig rig;
    std::vector<uint32_t> rig_joints;  // [joint_count], numbers in the character
    std::vector<bool> fixed;           // [joint_count], fused/fixed_joints.h
    uint32_t palette_count = 0;
    uint32_t most_binds = 0;  // palette entries of one joint
};

// How a scan method is applied to a character in one pass.
struct FusedPlan {
    std::string unsupported_reason;  // why the method does not apply; empty if it does
    ScanChoice choice;
    ScanPlan scan;
    uint32_t tile_transforms = 0;  // local transforms that pass through shared memory together; 0: none do
    bool one_bind = false;         // no joint has two palette entries
    // The kernel's loops, like ScanCounts::loops, if clips are packed, one or two are blended and no joint has two
    // palette entries; other kernels have more loops.
    std::vector<LoopTrips> loops;
};

FusedPlan plan_fused(const ScanChoice& choice, const FusedRig& rig, const ScanLimits& limits);

// For a device that holds `subgroups_a_character` subgroups at once for each character. Tries the plans that are likely
// best in turn: returns the first that applies, or why the last one does not.
FusedPlan choose_fused(const FusedRig& rig, const ScanLimits& limits, double subgroups_a_character = 0);

// What the kernel reads of a character beside its clips: kScanLinksBuffer of the plan, kBindRangesBuffer,
// kBindEntriesBuffer, kBindsBuffer and kAnimatedJointsBuffer of the rig's joints.
// Uses `binds` if rows are read, else the character's inverse binds.
Buffers upload_fused_tables(Uploads& uploads, const Character& character, const FusedRig& rig, const FusedPlan& plan,
                            const FusedBinds* binds = nullptr);

Kernel fused_kernel(const std::shared_ptr<Gpu>& gpu, const FusedPlan& plan, const FusedSettings& settings);

// For all instances.
void record_fused(VkCommandBuffer commands, const Kernel& kernel, const Bindings& bindings, const FusedPlan& plan,
                  const io::FusedPush& push);

}  // namespace throng
