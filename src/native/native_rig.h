// A character as the native engine walks it.
//
// With B the bind pose of a joint (model_from_bind joint, a similarity), S = M B^-1 obeys S = S_parent L', where L' =
// B_parent L B^-1: the walk then yields skin matrices with one product a joint. As conjugating by constants is linear,
// interpolating and blending commute with it, and so do hemispheres and differences of poses: the rows are conjugated
// once, here. A joint that is not bound, or not by a similarity, has another space for B; palette entries for which S
// is not the skin matrix, model matrices and sockets are S times a constant. Where joints are scaled differently along
// x, y and z all B are the identity.
#pragma once

#include "native/aligned.h"
#include "native/kernel_data.h"
#include "native/rows.h"

#include <throng/character.h>
#include <throng/skin_format.h>

#include <span>
#include <vector>

namespace throng {

struct NativeRigSettings {
    uint32_t lod = 0;                 // of Character::lods: joints that do not move in it are left out
    bool keeps_model = false;         // model matrices are written
    std::vector<uint32_t> sockets{};  // joints
    bool sockets_only = false;        // nothing else is written, and no joint walked that none of them hangs on
    bool all_move = false;            // poses may be set, in which any joint may be anywhere

    bool operator==(const NativeRigSettings&) const = default;
};

class NativeRig {
public:
    explicit NativeRig(const Character& character, const NativeRigSettings& settings = {});
    NativeRig(NativeRig&&) noexcept = default;
    NativeRig& operator=(NativeRig&&) noexcept = default;

    uint64_t size_bytes() const;
    uint64_t row_bytes() const { return rows_.size_bytes(); }
    // masks[mask][joint of the rig], 0..1, in the order that updates read: made once for all of them.
    native::AlignedBytes masks_in_order(std::span<const float> masks) const;
    // A pose from outside, likewise; of a rig whose joints all move.
    size_t pose_floats() const { return size_t{kernel_.place_count} * 4; }
    void put_pose(std::span<const Trs<float>> parent_from_joint, std::span<float> pose) const;
    size_t inertia_floats() const { return size_t{kernel_.place_count} * native::kInertiaFloats; }
    const native::KernelRig& kernel() const { return kernel_; }

private:
    native::Rows rows_;
    std::vector<native::WalkStep> steps_;
    std::vector<native::Emission> emissions_;
    std::vector<float> constants_;
    std::vector<native::RowJoint> joints_;    // in the order of the walk
    std::vector<uint32_t> joints_of_places_;  // kNone: of none
    native::KernelRig kernel_;
};

}  // namespace throng
