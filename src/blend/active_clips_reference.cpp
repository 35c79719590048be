#include "blend/active_clips_reference.h"

#include "blend/blend_reference.h"

namespace throng {
namespace {

constexpr double kCancelled = 1e-6;  // a shorter sum of rotations has no direction
constexpr double kNoScale = 1e-8;

Quaternion<double> operator+(const Quaternion<double>& a, const Quaternion<double>& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z, a.w + b.w};
}
Quaternion<double> operator*(const Quaternion<double>& q, double s) { return {q.x * s, q.y * s, q.z * s, q.w * s}; }

double ratio(double to, double from) { return std::abs(from) < kNoScale ? 1 : to / from; }

Trs<double> sum_of(const ReferenceLayer& layer) {
    Trs<double> sum{.rotation = {0, 0, 0, 0}, .translation = {}, .scale = {0, 0, 0}}, part;
    for (const ReferenceActiveClip& active_clip : layer.active_clips) {
        part = layer.is_additive ? pose_difference_reference(active_clip.pose, active_clip.first) : active_clip.pose;
        const bool is_far_side = !layer.is_additive && dot(part.rotation, sum.rotation) < 0;
        sum.rotation = sum.rotation + (is_far_side ? -part.rotation : part.rotation) * active_clip.weight;
        sum.translation = sum.translation + part.translation * active_clip.weight;
        sum.scale = sum.scale + part.scale * active_clip.weight;
    }
    const bool has_direction = std::sqrt(dot(sum.rotation, sum.rotation)) >= kCancelled;
    sum.rotation = has_direction ? normalized(sum.rotation) : part.rotation;
    return sum;
}

Trs<double> add(const Trs<double>& difference, const Trs<double>& pose) {
    return {difference.rotation * pose.rotation,
            pose.translation + difference.translation,
            {pose.scale.x * difference.scale.x, pose.scale.y * difference.scale.y, pose.scale.z * difference.scale.z}};
}

}  // namespace

Trs<double> pose_difference_reference(const Trs<double>& to, const Trs<double>& from) {
    const Quaternion<double>& r = from.rotation;
    const Quaternion<double> turn = to.rotation * Quaternion<double>{-r.x, -r.y, -r.z, r.w};
    return {turn.w < 0 ? -turn : turn,
            to.translation - from.translation,
            {ratio(to.scale.x, from.scale.x), ratio(to.scale.y, from.scale.y), ratio(to.scale.z, from.scale.z)}};
}

Trs<double> active_clips_reference(std::span<const ReferenceLayer> layers) {
    return joint_reference(layers, nullptr).pose;
}

ReferenceJoint joint_reference(std::span<const ReferenceLayer> layers, const ReferenceJoint* parent) {
    ReferenceJoint joint{.pose = {}, .rotations = std::vector<ReferenceRotations>(layers.size())};
    Trs<double>& result = joint.pose;
    for (size_t i = 0; i < layers.size(); ++i) {
        const ReferenceLayer& layer = layers[i];
        const double weight = i == 0 ? 1 : layer.weight;
        const Trs<double> sum = sum_of(layer);
        const Trs<double> below = result;
        result = layer.is_additive ? add(blend_reference(sum, {}, weight), below) : blend_reference(sum, below, weight);
        if (!layer.in_model_space || i == 0) continue;  // for the lowest layer, either space gives the same rotations
        const ReferenceRotations above = parent ? parent->rotations[i] : ReferenceRotations{};
        ReferenceRotations& here = joint.rotations[i];
        here = {.below = above.below * below.rotation,
                .layer = above.layer * sum.rotation,
                .blended = above.blended * below.rotation};
        if (weight > 0)
            here.blended = blend_reference({.rotation = here.layer}, {.rotation = here.below}, weight).rotation;
        const Quaternion<double>& q = above.blended;
        result.rotation = weight > 0 ? Quaternion<double>{-q.x, -q.y, -q.z, q.w} * here.blended : below.rotation;
    }
    return joint;
}

}  // namespace throng
