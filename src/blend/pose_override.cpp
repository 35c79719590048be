#include "blend/pose_override.h"

#include "base/failure.h"
#include "base/finite.h"

#include <algorithm>
#include <cmath>

namespace throng {
namespace {

constexpr double kUniform = 1e-5;  // scales that differ by at most this fraction of the largest count as equal

bool is_uniform(const Vec3<double>& s) {
    const double bound = kUniform * std::max({std::abs(s.x), std::abs(s.y), std::abs(s.z)});
    return std::abs(s.x - s.y) <= bound && std::abs(s.x - s.z) <= bound;
}

}  // namespace

void PoseFade::set(float fade_s) {
    if (is_set_) return;
    is_set_ = true;
    if (fade_s > 0)
        rate_ = 1 / fade_s;
    else
        fade_ = 1;
}

void PoseFade::clear(float fade_s) {
    is_set_ = false;
    if (fade_s > 0)
        rate_ = 1 / fade_s;
    else
        fade_ = 0;
}

float PoseFade::weight() const { return fade_ * fade_ * (3 - 2 * fade_); }

void PoseFade::advance(float time_step_s) {
    if (!is_moving() || !(time_step_s > 0)) return;
    const float step = time_step_s * rate_;
    fade_ = is_set_ ? std::min(fade_ + step, 1.0f) : std::max(fade_ - step, 0.0f);
}

void check_fade(float fade_s, const ErrorPlace& place) {
    if (!(fade_s >= 0 && std::isfinite(fade_s))) refuse(place, "the fade must be finite, and not negative");
}

std::vector<Trs<double>> checked_pose(std::span<const Trs<float>> parent_from_joint, uint32_t joint_count,
                                      bool uniform_scale, const ErrorPlace& place) {
    if (parent_from_joint.size() != joint_count)
        refuse(place, std::to_string(parent_from_joint.size()) + " transforms for a character that has " +
                          std::to_string(joint_count) + " joints");
    std::vector<Trs<double>> pose;
    pose.reserve(parent_from_joint.size());
    for (const Trs<float>& given : parent_from_joint) {
        Trs<double> joint = given.as<double>();
        const auto name = [&] { return "joint " + std::to_string(pose.size()) + ": "; };
        if (!all_finite(joint)) refuse(place, name() + "a number is not finite");
        if (dot(joint.rotation, joint.rotation) == 0) refuse(place, name() + "its rotation has length 0");
        joint.rotation = normalized(joint.rotation);
        if (uniform_scale) {
            if (!is_uniform(joint.scale))
                refuse(place, name() +
                                  "its scale differs along the axes, but this character's scales must be uniform "
                                  "(Rig::uniform_scale)");
            joint.scale = {joint.scale.x, joint.scale.x, joint.scale.x};
        }
        pose.push_back(joint);
    }
    return pose;
}

}  // namespace throng
