#include "tools/view/orbit.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace throng::view {
namespace {

// How far the user can turn: from a little below, so as not to dive under the ground, to almost straight above
constexpr float kMinPitch_rad = -0.3f, kMaxPitch_rad = 1.5f;
constexpr float kSteepest_rad = 1.55f;  // beyond it the picture would have no up

Vec3<float> direction_of(float yaw_rad, float pitch_rad) {
    return {std::cos(pitch_rad) * std::sin(yaw_rad), std::sin(pitch_rad), std::cos(pitch_rad) * std::cos(yaw_rad)};
}

}  // namespace

void Orbit::reset(const Camera& camera) {
    const Vec3<float> back = camera.eye - camera.target, unit = normalized(back);
    target_ = camera.target;
    distance_ = reach_ = std::max(length(back), 1e-6f);
    yaw_rad_ = std::atan2(unit.x, unit.z);
    pitch_rad_ = std::clamp(std::asin(std::clamp(unit.y, -1.0f, 1.0f)), -kSteepest_rad, kSteepest_rad);
    field_of_view_rad_ = camera.vertical_field_of_view_rad;
}

void Orbit::fit(const Bounds& bounds, const PicturePart& part, float aspect_ratio) {
    const float ratio_of_part = aspect_ratio * part.width() / part.height();
    reset(fit_camera(bounds, ratio_of_part));
    const auto lies_in = [](const Vec3<float>& at, const PicturePart& within) {
        return at.x >= within.left && at.x <= within.right && at.y >= within.top && at.y <= within.bottom;
    };
    const Projection alone(camera(), ratio_of_part);
    std::vector<Vec3<float>> corners;  // except those that fit_camera() leaves out, of a vast crowd
    for (size_t i = 0; i < 8; ++i) {
        const Vec3<float> corner{(i & 1 ? bounds.max : bounds.min).x, (i & 2 ? bounds.max : bounds.min).y,
                                 (i & 4 ? bounds.max : bounds.min).z};
        if (lies_in(alone.project(corner), PicturePart())) corners.push_back(corner);
    }
    const auto shows_all = [&] {
        const Projection picture(camera_around(camera(), part, aspect_ratio), aspect_ratio);
        return std::ranges::all_of(corners,
                                   [&](const Vec3<float>& corner) { return lies_in(picture.project(corner), part); });
    };
    constexpr int kMostSteps = 50;
    for (int step = 0; step < kMostSteps && !shows_all(); ++step) distance_ *= 1.02f;
    reach_ = distance_;
}

Vec3<float> Orbit::to_eye() const { return direction_of(yaw_rad_, pitch_rad_); }

Camera Orbit::camera() const { return {target_ + to_eye() * distance_, target_, field_of_view_rad_}; }

void Orbit::turn(float yaw_rad, float pitch_rad) {
    const bool was_above_ground = is_above_ground();
    yaw_rad_ += yaw_rad;
    pitch_rad_ = std::clamp(pitch_rad_ + pitch_rad, std::min(kMinPitch_rad, pitch_rad_),
                            std::max(kMaxPitch_rad, pitch_rad_));
    if (was_above_ground) stay_above_ground();
}

void Orbit::stay_above_ground() {
    constexpr float kHeight = 0.02f;  // of the eye above the ground, as a fraction of its distance from the target
    const float least = std::asin(std::clamp((ground_y_ - target_.y) / distance_ + kHeight, -1.0f, 1.0f));
    pitch_rad_ = std::max(pitch_rad_, std::min(least, kMaxPitch_rad));
}

void Orbit::look(float yaw_rad, float pitch_rad) {
    const Vec3<float> eye = camera().eye;
    turn(yaw_rad, pitch_rad);
    target_ = eye - to_eye() * distance_;
}

void Orbit::pan(float right, float up) {
    const Projection axes(camera(), 1);
    target_ = target_ + (axes.right() * right + axes.up() * up) * (2 * distance_ * std::tan(field_of_view_rad_ / 2));
}

void Orbit::zoom(float factor) {
    const bool was_above_ground = is_above_ground();
    distance_ = std::clamp(distance_ * factor, reach_ * 1e-4f, reach_ * 20);
    if (was_above_ground) stay_above_ground();
}

void Orbit::fly(float right, float up, float forward) {
    const Vec3<float> ahead = to_eye() * -1.0f, aside{-ahead.z, 0, ahead.x};
    target_ = target_ + (normalized(aside) * right + Vec3<float>{0, up, 0} + ahead * forward) * reach_;
}

Camera camera_around(const Camera& camera, const PicturePart& part, float aspect_ratio) {
    const float half_height = std::tan(camera.vertical_field_of_view_rad / 2) / part.height(),
                right = (part.left + part.right - 1) * half_height * aspect_ratio,
                up = (1 - part.top - part.bottom) * half_height;
    // The old target's ray is forward + right * axes.right() + up * axes.up(), where axes.right() is level. So the
    // ray's height gives the pitch, and the rest of it the yaw.
    const Vec3<float> ahead = camera.target - camera.eye, ray = normalized(ahead);
    const float rise = ray.y * std::hypot(1.0f, right, up) / std::hypot(1.0f, up);
    const float pitch_rad = std::clamp(std::asin(std::clamp(rise, -1.0f, 1.0f)) - std::atan(up), -kSteepest_rad,
                                       kSteepest_rad);
    const float yaw_rad = std::atan2(ray.x, ray.z) + std::atan2(right, std::cos(pitch_rad) - up * std::sin(pitch_rad));
    return {camera.eye, camera.eye + direction_of(yaw_rad, pitch_rad) * length(ahead), 2 * std::atan(half_height)};
}

Projection::Projection(const Camera& camera, float aspect_ratio)
    : eye_(camera.eye),
      forward_(normalized(camera.target - camera.eye)),
      half_height_(std::tan(camera.vertical_field_of_view_rad / 2)) {
    right_ = normalized(cross(forward_, Vec3<float>{0, 1, 0}));
    up_ = cross(right_, forward_);
    half_width_ = half_height_ * aspect_ratio;
}

Projection::Ray Projection::ray(float x, float y) const {
    return {eye_, forward_ + right_ * ((2 * x - 1) * half_width_) + up_ * ((1 - 2 * y) * half_height_)};
}

Vec3<float> Projection::project(const Vec3<float>& world_place) const {
    const Vec3<float> from_eye = world_place - eye_;
    const float depth = dot(from_eye, forward_);
    return {0.5f + 0.5f * dot(from_eye, right_) / (depth * half_width_),
            0.5f - 0.5f * dot(from_eye, up_) / (depth * half_height_), depth};
}

}  // namespace throng::view
