#include "bind/pose_of_skin.h"

#include "base/affine.h"

#include <cmath>

namespace throng {
namespace {

// Averages the three scales, since set_pose() would reject scales that differ by rounding. The scale is negative if the
// matrix mirrors.
Trs<double> with_uniform_scale(AffineT<double> parent_from_joint) {
    const double sign = determinant(parent_from_joint) < 0 ? -1 : 1;
    for (auto& row : parent_from_joint.row)
        for (size_t c = 0; c < 3; ++c) row[c] *= sign;
    Trs<double> trs = decomposed(parent_from_joint).trs;
    const double scale = sign * (trs.scale.x + trs.scale.y + trs.scale.z) / 3;
    trs.scale = {scale, scale, scale};
    return trs;
}

}  // namespace

PoseOfSkin::PoseOfSkin(const Character& character) : uniform_scale_(character.rig.uniform_scale) {
    const Rig& rig = character.rig;
    for (uint32_t j = 0; j < rig.joint_count(); ++j)
        joints_.push_back({.parent = rig.parents[j], .entry = kNone, .bind_from_joint = {}, .rest = rig.rest[j]});
    for (uint32_t entry = 0; entry < character.palette.size(); ++entry) {
        Joint& joint = joints_[character.palette[entry].joint];
        const auto bind_from_joint = inverse(character.palette[entry].joint_from_bind.as<double>());
        if (joint.entry != kNone || !bind_from_joint) continue;
        joint.entry = entry;
        joint.bind_from_joint = *bind_from_joint;
    }
}

void PoseOfSkin::append(std::span<const Affine> model_from_bind, std::vector<Trs<float>>& pose) const {
    std::vector<AffineT<double>> model_from_joint;
    model_from_joint.reserve(joints_.size());
    for (const Joint& joint : joints_) {
        const AffineT<double> model_from_parent = joint.parent == kNone ? AffineT<double>{}
                                                                        : model_from_joint[joint.parent];
        const auto parent_from_model = inverse(model_from_parent);
        if (joint.entry == kNone || !parent_from_model) {
            pose.push_back(joint.rest);
            model_from_joint.push_back(model_from_parent * to_affine(joint.rest.as<double>()));
            continue;
        }
        model_from_joint.push_back(model_from_bind[joint.entry].as<double>() * joint.bind_from_joint);
        const AffineT<double> parent_from_joint = *parent_from_model * model_from_joint.back();
        pose.push_back(
            (uniform_scale_ ? with_uniform_scale(parent_from_joint) : decomposed(parent_from_joint).trs).as<float>());
    }
}

}  // namespace throng
