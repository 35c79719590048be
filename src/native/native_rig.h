// A character as the native engine walks it.
//
// Of a joint, let L be the local matrix, M the model matrix, and B the bind pose (model_from_joint, a similarity). Then
// S = M B^-1 obeys S = S_parent L', where L' = B_parent L B^-1, and the walk yields skin matrices with one product per
// joint. Conjugating by constants is linear, so interpolating and blending commute with it, and so do hemispheres and
// differences of poses. That is why the rows can be conjugated once, here.
//
// A joint that is not bound, or not by a similarity, uses another space as B. Model matrices, sockets, and those skin
// matrices that differ from S are S times a constant. If joints are scaled differently along x, y and z, every B is the
// identity.
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
    uint32_t lod = 0;                 // level of detail (Character::lods): joints that do not move in it are left out
    bool keeps_model = false;         // model matrices are written
    std::vector<uint32_t> sockets{};  // joints
    bool sockets_only = false;        // only sockets are written, and only joints that they depend on are walked
    bool all_move = false;            // pose overrides may put any joint anywhere
};

class NativeRig {
public:
    explicit NativeRig(const Character& character, const NativeRigSettings& settings = {});
    NativeRig(NativeRig&&) noexcept = default;
    NativeRig& operator=(NativeRig&&) noexcept = default;

    uint64_t size_bytes() const;
    uint64_t row_bytes() const { return rows_.size_bytes(); }
    // Returns `masks`, [mask][joint of the rig], 0..1, in the order in which updates read them. Call it once for all
    // updates.
    native::AlignedBytes masks_in_order(std::span<const float> masks) const;
    // put_pose() writes a pose override, of pose_floats() floats, in that order and in the spaces of the rows. The rig
    // must have been made with all_move.
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
    std::vector<uint32_t> joints_of_places_;  // [place]; kNone: no joint
    native::KernelRig kernel_;
};

}  // namespace throng
