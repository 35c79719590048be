#include "blend/inertia_reference.h"

#include <algorithm>
#include <cmath>

namespace throng {
namespace {

constexpr double kPi = 3.14159265358979323846;

ReferenceInertia::Offset offset_of(const Vec3<double>& now, const Vec3<double>& before, double time_step_s) {
    const Vec3<double> direction = normalized(now);
    return {direction, length(now), std::min((length(now) - dot(before, direction)) / time_step_s, 0.0)};
}

Quaternion<double> turn_between(const Quaternion<double>& to, const Quaternion<double>& from) {
    const Quaternion<double> turn = to * Quaternion<double>{-from.x, -from.y, -from.z, from.w};
    return turn.w < 0 ? -turn : turn;
}

ReferenceInertia::Offset offset_of(const Quaternion<double>& now, const Quaternion<double>& before,
                                   double time_step_s) {
    const Vec3<double> sine{now.x, now.y, now.z}, axis = normalized(sine);
    const double angle_rad = 2 * std::atan2(length(sine), now.w);
    const double angle_before_rad = 2 * std::atan2(dot({before.x, before.y, before.z}, axis), before.w);
    return {axis, angle_rad, std::min(std::remainder(angle_rad - angle_before_rad, 2 * kPi) / time_step_s, 0.0)};
}

}  // namespace

double decayed_reference(double x, double v, double elapsed_s, double duration_s) {
    const double end_s = v < 0 ? std::min(duration_s, -5 * x / v) : duration_s;
    if (elapsed_s >= end_s) return 0;
    const double acceleration = std::max((-8 * v * end_s - 20 * x) / (end_s * end_s), 0.0);  // initial
    const double a = acceleration * end_s * end_s, u = v * end_s, s = elapsed_s / end_s;
    return -(a + 6 * u + 12 * x) / 2 * std::pow(s, 5) + (3 * a + 16 * u + 30 * x) / 2 * std::pow(s, 4) -
           (3 * a + 12 * u + 20 * x) / 2 * std::pow(s, 3) + a / 2 * s * s + u * s + x;
}

ReferenceInertia inertia_begin_reference(const InertiaPoses& p, double time_step_s) {
    return {offset_of(turn_between(p.shown.rotation, p.target.rotation),
                      turn_between(p.shown_before.rotation, p.target_before.rotation), time_step_s),
            offset_of(p.shown.translation - p.target.translation,
                      p.shown_before.translation - p.target_before.translation, time_step_s),
            offset_of(p.shown.scale - p.target.scale, p.shown_before.scale - p.target_before.scale, time_step_s)};
}

Trs<double> inertia_apply_reference(const ReferenceInertia& inertia, double elapsed_s, double duration_s,
                                    const Trs<double>& target) {
    const auto left = [&](const ReferenceInertia::Offset& offset) {
        return decayed_reference(offset.size, offset.speed, elapsed_s, duration_s);
    };
    return {axis_angle(inertia.rotation.direction, left(inertia.rotation)) * target.rotation,
            target.translation + inertia.translation.direction * left(inertia.translation),
            target.scale + inertia.scale.direction * left(inertia.scale)};
}

}  // namespace throng
