#include "creature_bones.h"

namespace throng::creature {

// Quadratic B-spline over the bounds: three joints, smooth, half each of both neighbours where two bones meet.
Influences influences_at(const Bones& bones, double t, double scale) {
    const auto& b = bones.bounds;
    const size_t last = bones.joints.size() - 1;
    const size_t i = size_t(std::upper_bound(b.begin() + 1, b.end() - 1, t) - b.begin()) - 1;
    const double length = b[i + 1] - b[i];
    const double x = std::clamp((t - b[i]) / length, 0.0, 1.0);
    const double before = i > 0 ? (1 - x) * (1 - x) * length / (b[i + 1] - b[i - 1]) : 0;
    const double after = i < last ? x * x * length / (b[i + 2] - b[i]) : 0;
    Influences out;
    const auto add = [&](size_t bone, double weight) {
        if (bone > 0 || bones.base.empty())
            out.push_back({bones.joints[bone], scale * weight});
        else
            for (const Influence& influence : bones.base)
                out.push_back({influence.joint, scale * weight * influence.weight});
    };
    add(i, 1 - before - after);
    if (before > 0) add(i - 1, before);
    if (after > 0) add(i + 1, after);
    return out;
}

Bones bones_of_axis(const Body& body) {
    Bones bones{{}, {0}, {}};
    if (const Chain* trunk = body.find(Part::kTrunk))
        for (uint32_t k = trunk->joint_count; k-- > 0;) {
            bones.joints.push_back(trunk->first_joint + k);
            bones.bounds.push_back(trunk->at(k));
        }
    bones.joints.push_back(0);
    if (const Chain* tail = body.find(Part::kTail))
        for (uint32_t k = 0; k < tail->joint_count; ++k) {
            bones.joints.push_back(tail->first_joint + k);
            bones.bounds.push_back(tail->at(k));
        }
    bones.bounds.push_back(1);
    return bones;
}

Bones bones_of_limb(const Chain& chain, const Bones& axis) {
    Bones bones{{chain.parent_joint}, {-chain.step}, {}};
    if (chain.grows_at) bones.base = influences_at(axis, *chain.grows_at);
    for (uint32_t k = 0; k < chain.joint_count; ++k) {
        bones.joints.push_back(chain.first_joint + k);
        bones.bounds.push_back(chain.at(k));
    }
    bones.bounds.push_back(1);
    return bones;
}

}  // namespace throng::creature
