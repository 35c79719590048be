// A character that walks, with root motion in its clips.
#pragma once

#include "tests/test_rig.h"

#include <throng/throng.h>

#include <functional>
#include <numbers>
#include <vector>

namespace throng::test {

inline constexpr Vec3<double> kUp{0, 1, 0};

struct ModelPose {
    Quaternion<double> rotation;
    Vec3<double> position;
};
using Motion = std::function<ModelPose(double time_s)>;

// A left circle at 1.2 m/s and 50 degrees/s, with the sway of a walk: two steps per second.
ModelPose walk(double time_s);

// A walker: hips with a leg, under an armature that is turned and scaled as exporters do. The armature may be a joint
// or not.
struct Walker {
    Asset asset{.name = "walker"};
    Trs<double> armature{
        axis_angle(normalized(Vec3<double>{1, 0.1, 0}), -std::numbers::pi / 2), {0.3, -0.1, 0.2}, {0.01, 0.01, 0.01}};
    enum : uint32_t { kArmature, kHips, kLeg };

    explicit Walker(bool armature_is_joint);

    void clip(const char* name, double duration_s) { asset.clips.push_back({.name = name, .duration_s = duration_s}); }
    void track(uint32_t node, TrackTarget target, const std::vector<float>& times_s, const std::vector<float>& values,
               Interpolation interpolation = Interpolation::kLinear) {
        asset.clips.back().tracks.push_back(
            {.node = node, .target = target, .interpolation = interpolation, .times_s = times_s, .values = values});
    }

    // Adds keys at these times so that the hips move like `motion` in model space; the leg swings.
    void move(const char* name, const std::vector<float>& times_s, const Motion& motion,
              Interpolation interpolation = Interpolation::kLinear);
};

std::vector<float> times(double duration_s, double rate);

}  // namespace throng::test
