// Inertial transitions: the shader functions against the reference, and the reference's own guarantees.
#include "blend/inertia_io.h"
#include "blend/inertia_reference.h"
#include "sample/sample_io.h"
#include "tests/joint_pose.h"
#include "tests/kernel_runner.h"
#include "tests/subset.h"
#include "tests/test_rig.h"

#include <cmath>
#include <cstdio>
#include <numbers>

namespace throng {
namespace {

const test::InSubset kInertiaInSubsets({test::Subset::kGpuAssisted, test::Subset::kSubgroups}, {"Inertia.*"});

using namespace test;

constexpr uint32_t kSpirv[] = {
#include "inertia.comp.inc"
};

constexpr double kInertiaBound = 2e-6;  // of an element of the matrix
constexpr double kTimeStep_s = 1.0 / 60;

Trs<double> as_unit_trs(const io::JointPose& p) {
    return {normalized(Quaternion<double>{p.rotation.x, p.rotation.y, p.rotation.z, p.rotation.w}),
            {p.translation.x, p.translation.y, p.translation.z},
            {p.scale.x, p.scale.y, p.scale.z}};
}

TEST(Inertia, DecaysToRestWithoutOvershoot) {
    constexpr double kStep_s = 1e-5;
    for (const double x : {1e-3, 0.5, 3.0}) {
        for (const double speed : {0.0, -0.1, -1.0, -2.6, -4.9, -20.0}) {  // in offsets a second
            for (const double duration_s : {0.1, 0.5, 1.0}) {
                const double v = x * speed, end_s = std::min(duration_s, speed < 0 ? -5 / speed : duration_s);
                const auto at = [&](double t) { return decayed_reference(x, v, t, duration_s); };
                EXPECT_EQ(at(0), x);
                // The error is half the acceleration times the step
                EXPECT_NEAR((at(kStep_s) - at(0)) / kStep_s, v, x * 1e-2 / (end_s * end_s));
                EXPECT_EQ(at(end_s), 0);
                EXPECT_EQ(at(2 * duration_s), 0);
                EXPECT_LE(at(end_s * 0.999), x * 1e-7) << "arrives with neither speed nor acceleration";
                for (int i = 1; i <= 1000; ++i) {
                    EXPECT_LE(at(end_s * i / 1000), at(end_s * (i - 1) / 1000) + x * 1e-14) << speed;
                    EXPECT_GE(at(end_s * i / 1000), -x * 1e-14) << speed;  // rounding
                }
            }
        }
    }
    EXPECT_EQ(decayed_reference(0, 0, 0.1, 1), 0);
    EXPECT_EQ(decayed_reference(1, 0, 0, 0), 0) << "a transition that takes no time";
}

// A swing toward a moving target is interrupted: neither position nor speed may jump.
TEST(Inertia, PositionAndSpeedAreContinuous) {
    // The quintic's largest is about 10 offsets / duration^2
    constexpr double kStep_s = 1e-3, kDuration_s = 0.4, kSwitch_s = 0.5, kAcceleration = 120;
    const Vec3<double> axis = normalized(Vec3<double>{1, 2, -1});
    const auto source = [&](double t) {
        return Trs<double>{axis_angle(axis, 1.6 - t), {2 - t, 0, 1}, Vec3<double>{1, 1, 1} * (2 - t)};
    };
    const auto target = [&](double t) {
        return Trs<double>{axis_angle(axis, 0.2 * t), {t, 0, 1}, Vec3<double>{1, 1, 1} * (0.5 + t)};
    };
    const ReferenceInertia inertia = inertia_begin_reference(
        {source(kSwitch_s), source(kSwitch_s - kStep_s), target(kSwitch_s), target(kSwitch_s - kStep_s)}, kStep_s);
    const auto shown = [&](double t) {
        return t <= kSwitch_s ? source(t) : inertia_apply_reference(inertia, t - kSwitch_s, kDuration_s, target(t));
    };
    const auto angle = [&](double t) {
        const Quaternion<double> q = shown(t).rotation;
        return 2 * std::atan2(dot({q.x, q.y, q.z}, axis), q.w);
    };
    for (double t = kSwitch_s - 0.1; t < kSwitch_s + 0.6; t += kStep_s) {
        const auto bend = [&](auto&& value) {
            return std::abs(value(t + kStep_s) - 2 * value(t) + value(t - kStep_s)) / (kStep_s * kStep_s);
        };
        EXPECT_LE(bend(angle), kAcceleration) << "at " << t;
        EXPECT_LE(bend([&](double at) { return shown(at).translation.x; }), kAcceleration) << "at " << t;
        EXPECT_LE(bend([&](double at) { return shown(at).scale.y; }), kAcceleration) << "at " << t;
    }
    EXPECT_EQ(shown(kSwitch_s + kDuration_s).translation, target(kSwitch_s + kDuration_s).translation);
}

// If the offset is growing, its initial speed is taken as 0.
TEST(Inertia, AGrowingOffsetStartsWithoutSpeed) {
    const Trs<double> rest;
    const Trs<double> away{axis_angle(Vec3<double>{1, 0, 0}, 0.5), {0, 2, 0}, {1, 1, 3}},
        less{axis_angle(Vec3<double>{1, 0, 0}, 0.4), {0, 1, 0}, {1, 1, 2}};
    const ReferenceInertia growing = inertia_begin_reference({away, less, rest, rest}, kTimeStep_s),
                           shrinking = inertia_begin_reference({less, away, rest, rest}, kTimeStep_s);
    EXPECT_EQ(growing.rotation.speed, 0);
    EXPECT_EQ(growing.translation.speed, 0);
    EXPECT_EQ(growing.scale.speed, 0);
    EXPECT_NEAR(shrinking.rotation.speed, -6, 1e-9);
    EXPECT_NEAR(shrinking.translation.speed, -60, 1e-9);
    EXPECT_NEAR(shrinking.scale.speed, -60, 1e-9);
    EXPECT_NEAR(shrinking.rotation.size, 0.4, 1e-12);

    const auto turned = [](double angle_rad) {
        return Trs<double>{axis_angle(Vec3<double>{1, 0, 0}, angle_rad), {}, {1, 1, 1}};
    };
    EXPECT_NEAR(inertia_begin_reference({turned(std::numbers::pi - 0.1), turned(std::numbers::pi + 0.1), rest, rest},
                                        kTimeStep_s)
                    .rotation.speed,
                -12, 1e-9)
        << "from beyond half a turn";
}

TEST(Inertia, TheShadersFollowTheReference) {
    Random random(8);
    std::vector<io::JointPose> poses;
    const auto near = [&](const Trs<double>& t, double extent) {
        Trs<double> out{t.rotation * axis_angle(random.direction(), random.between(0, extent)),
                        t.translation + random.vector(extent), t.scale + random.vector(extent * 0.2)};
        if (random.chance(0.5)) out.rotation = -out.rotation;
        return out;
    };
    for (int i = 0; i < 2000; ++i) {
        // Less than half a turn, where both directions would be equally short
        const Trs<double> target = random.trs(1, 0.3),
                          shown = i % 10 == 0 ? target : near(target, i % 10 == 1 ? 0.01 : 2.8);
        for (const Trs<double>& t :
             {shown, i % 3 == 0 ? shown : near(shown, 0.05), target, i % 2 == 0 ? target : near(target, 0.05)})
            poses.push_back(to_pose(t));
    }
    for (int i = 0; i < 100; ++i) {  // turns that pass half a turn
        const Trs<double> target = random.trs(1, 0.3);
        const Vec3<double> axis = random.direction();
        Trs<double> shown = target, before = target;
        shown.rotation = axis_angle(axis, std::numbers::pi - random.between(0.001, 0.02)) * target.rotation;
        before.rotation = axis_angle(axis, std::numbers::pi + random.between(0.001, 0.02)) * target.rotation;
        for (const Trs<double>& t : {shown, before, target, target}) poses.push_back(to_pose(t));
    }
    const auto count = static_cast<uint32_t>(poses.size() / 4);
    struct Push {
        uint32_t joint_count;
        float time_step_s, elapsed_s, duration_s;
    };
    const Guarded<io::JointPose> inputs(poses);
    const Kernel kernel(test_gpu(), {.name = "inertia", .spirv = kSpirv});
    double worst = 0;
    for (const float elapsed_s : {0.0f, 0.016f, 0.05f, 0.1f, 0.2f, 0.29f, 0.3f, 1.0f}) {
        const Guarded<io::JointPose> results(poison<io::JointPose>(count));
        run_invocations(kernel, BufferTable{{0, inputs}, {1, results}},
                        Push{count, static_cast<float>(kTimeStep_s), elapsed_s, 0.3f}, count);
        const std::vector<io::JointPose> got = results.read();
        for (size_t i = 0; i < count; ++i) {
            const Trs<double> target = as_unit_trs(poses[4 * i + 2]);
            const ReferenceInertia inertia = inertia_begin_reference(
                {as_unit_trs(poses[4 * i]), as_unit_trs(poses[4 * i + 1]), target, as_unit_trs(poses[4 * i + 3])},
                static_cast<float>(kTimeStep_s));
            const Trs<double> wanted = inertia_apply_reference(inertia, elapsed_s, 0.3f, target);
            // A speed is a difference divided by the time step. Its rounding error acts during the whole transition.
            const double error = matrix_error(to_affine(as_unit_trs(got[i])).as<float>(), to_affine(wanted), 1) /
                                 (1 + (elapsed_s < 0.3f ? elapsed_s / kTimeStep_s : 0));
            EXPECT_LE(error, kInertiaBound) << "joint " << i << " after " << elapsed_s;
            worst = std::max(worst, error);
            const Trs<double> end = elapsed_s == 0 ? as_unit_trs(poses[4 * i]) : target;
            if (elapsed_s == 0 || elapsed_s >= 0.3f) {
                EXPECT_LE(matrix_error(to_affine(as_unit_trs(got[i])).as<float>(), to_affine(end), 1), kInertiaBound)
                    << "the ends of the transition";
            }
        }
    }
    std::printf("  %u joints, 8 times: largest error %.1e\n", count, worst);
}

}  // namespace
}  // namespace throng
