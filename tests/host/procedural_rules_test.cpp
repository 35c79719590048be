// Procedural rules against angles and positions calculated in the tests.
#include "tests/procedural_cases.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace throng::test {
namespace {

constexpr double kRightAngle = std::numbers::pi / 2;

// The angle of a joint of chain() from +y towards +x, relative to its parent.
double turned_rad(const Trs<double>& parent_from_joint) {
    return -2 * std::atan2(parent_from_joint.rotation.z, parent_from_joint.rotation.w);
}

// The pose after one update with one rule.
Locals moved_by(const ProceduralRule& rule, const Character& character, Locals local,
                const ProceduralReference::Moment& moment) {
    const ProceduralRules rules{.targets = {}, .rules = {rule}};
    ProceduralReference(rules, character).update(local, moment);
    return local;
}

// ---- Reach

// A limb with a random pose, lengths and placement, which may be mirrored, and the position to which its rule moves the
// middle joint.
struct Reaching {
    Vec3<double> upper, middle, end, goal, pole;  // world space, before the rule
    Vec3<double> wanted_middle(const Vec3<double>& side) const;
    Vec3<double> got_middle;
};

// The corner of a triangle with three known sides, on the given `side` of the line to the goal.
Vec3<double> Reaching::wanted_middle(const Vec3<double>& side) const {
    const Vec3<double> to_goal = normalized(goal - upper), across = normalized(side - to_goal * dot(side, to_goal));
    const double a = length(middle - upper), b = length(end - middle), c = length(goal - upper);
    const double angle_rad = std::acos((a * a + c * c - b * b) / (2 * a * c));
    return upper + (to_goal * std::cos(angle_rad) + across * std::sin(angle_rad)) * a;
}

Reaching reach_somewhere(const Character& character, Random& random, bool is_straight) {
    const Vec3<double> pole = random.direction();
    const ProceduralRules rules{.targets = {"ledge"},
                                .rules = {ReachRule{.joint = "joint 5", .target = "ledge", .pole = pole.as<float>()}}};
    ProceduralReference reference(rules, character);
    Trs<double> place = random.trs(5, 0);
    place.scale = {random.chance(0.5) ? 2.0 : -2.0, 2, 2};
    const AffineT<double> world_from_model = to_affine(place);
    Locals local = rest_of(character);
    for (Trs<double>& joint : local) {
        joint.rotation = random.rotation();
        joint.translation = joint.translation * random.between(0.5, 2);
    }
    local[4].rotation = axis_angle(normalized(Vec3<double>{random.between(-1, 1), 0, 1}),
                                   is_straight ? 0 : random.between(0.05, 3));
    const auto world = [&](uint32_t joint) {
        return transform_point(world_from_model, place_of(character, local, joint));
    };
    Reaching limb{.upper = world(3), .middle = world(4), .end = world(5)};
    limb.pole = transform_vector(world_from_model * pose_from_local(character, local).model_from_joint[2], pole);
    const double a = length(limb.middle - limb.upper), b = length(limb.end - limb.middle);
    limb.goal = limb.upper +
                random.direction() * (std::abs(a - b) + random.between(0.1, 0.9) * (a + b - std::abs(a - b)));
    reference.targets[0] = {limb.goal, 1};
    reference.update(local, {.world_from_model = world_from_model, .wind = {}, .instance = 0, .time_step_s = 0});
    EXPECT_NEAR(length(world(5) - limb.goal), 0, 1e-6);
    limb.got_middle = world(4);
    return limb;
}

TEST(ProceduralRules, ALimbBendsToTheSideOfThePose) {
    const Character character = chain(6);
    Random random(5);
    for (int i = 0; i < 300; ++i) {
        const Reaching limb = reach_somewhere(character, random, false);
        // The shortest rotation from the limb's direction to the direction of the goal
        const Vec3<double> straight = normalized(limb.end - limb.upper), to_goal = normalized(limb.goal - limb.upper),
                           axis = cross(straight, to_goal);
        const Quaternion<double> swing = axis_angle(normalized(axis), std::atan2(length(axis), dot(straight, to_goal)));
        const Vec3<double> side = transform_vector(to_affine(Trs<double>{.rotation = swing}), limb.middle - limb.upper);
        EXPECT_NEAR(length(limb.got_middle - limb.wanted_middle(side)), 0, 1e-6) << i;
    }
}

TEST(ProceduralRules, AStraightLimbBendsTowardsThePole) {
    const Character character = chain(6);
    Random random(6);
    for (int i = 0; i < 300; ++i) {
        const Reaching limb = reach_somewhere(character, random, true);
        EXPECT_NEAR(length(limb.got_middle - limb.wanted_middle(limb.pole)), 0, 1e-5) << i;  // it is a float
    }
}

// ---- Springs

// The remaining fraction of an oscillator's initial displacement, released at rest, after some time.
double oscillation(double frequency_hz, double damping, double time_s) {
    const double omega = 2 * std::numbers::pi * frequency_hz, decay = damping * omega,
                 other = omega * std::sqrt(std::abs(1 - damping * damping));
    const auto times = [&](double even, double odd) { return std::exp(-decay * time_s) * (even + decay * odd); };
    if (damping == 1) return times(1, time_s);
    return damping < 1 ? times(std::cos(other * time_s), std::sin(other * time_s) / other)
                       : times(std::cosh(other * time_s), std::sinh(other * time_s) / other);
}

// The character is suddenly moved by a small distance. The step error of backward Euler adds up to half the step times
// (2 pi frequency)^2 per second: 0.011.
TEST(ProceduralRules, ASpringSwingsAsADampedOscillatorDoes) {
    constexpr double kFrequency_hz = 1.5, kWay = 0.01, kStep_s = 1.0 / 4000;
    const Character character = chain(2);
    for (const double damping : {0.0, 0.4, 1.0, 2.5}) {
        const ProceduralRules rules{.targets = {},
                                    .rules = {SpringRule{.joint = "joint 1",
                                                         .frequency_hz = static_cast<float>(kFrequency_hz),
                                                         .damping = static_cast<float>(damping)}}};
        ProceduralReference reference(rules, character);
        AffineT<double> placement;
        double worst = 0, lowest = 1;
        for (int step = 0; step <= 4000; ++step) {
            Locals local = rest_of(character);
            reference.update(local, {.world_from_model = placement, .wind = {}, .instance = 0, .time_step_s = kStep_s});
            placement.row[0][3] = -kWay;  // before the next step
            if (step == 0) continue;
            const double left = turned_rad(local[1]) / kWay;
            worst = worse_of(worst, std::abs(left - oscillation(kFrequency_hz, damping, step * kStep_s)));
            lowest = std::min(lowest, left);
        }
        EXPECT_LT(worst, 0.015) << "damping " << damping;
        EXPECT_EQ(lowest < 0, damping < 1) << "damping " << damping << ", as far as " << lowest;
    }
}

// At rest, the spring's restoring force and the forces at the bone's end add up to a force along the bone.
TEST(ProceduralRules, WindAndGravityPullASpringTheirWay) {
    const Character character = chain(2);
    const ProceduralRules rules{
        .targets = {},
        .rules = {SpringRule{.joint = "joint 1", .frequency_hz = 1, .damping = 1, .gravity = {0, -3, 5}, .drag = 2}}};
    ProceduralReference reference(rules, character);
    Locals local;
    for (int i = 0; i < 300; ++i) {
        local = rest_of(character);
        reference.update(local, {.world_from_model = {},
                                 .wind = blowing({.velocity = {10, 0, 0}, .gust = 0}),
                                 .instance = 0,
                                 .time_step_s = 1.0 / 20});
    }
    const double stiffness = std::pow(2 * std::numbers::pi, 2);
    const Vec3<double> bone = transform_vector(to_affine(local[1]), {0, 1, 0}),
                       wanted = normalized(Vec3<double>{0, stiffness, 0} + Vec3<double>{2 * 10, 0, 0} +
                                           Vec3<double>{0, -3, 5});
    EXPECT_NEAR(length(bone - wanted), 0, 1e-6);
}

// A sphere around a place beside the bone's end, which it pushes away at a right angle to the bone.
TEST(ProceduralRules, ACollidersRadiusIsScaledByTheLargestFactorOfItsJoint) {
    const Character character = chain(2);
    const Vec3<float> beside{-0.1f, 2, 0};
    const SpringRule rule{.joint = "joint 1",
                          .radius = 0.05f,
                          .colliders = {{.joint = "joint 0", .a = beside, .b = beside, .radius = 0.4f}}};
    for (const Vec3<double>& scale : {Vec3<double>{1, 1, 1}, {2, 2, 2}, {3, 1, 2}, {1, 3, 2}, {1, 2, 3}}) {
        Locals local = rest_of(character);
        local[0].scale = scale;
        local = moved_by(rule, character, local,
                         {.world_from_model = {}, .wind = {}, .instance = 0, .time_step_s = 1.0 / 60});
        const double away = 0.4 * std::max({scale.x, scale.y, scale.z}) + 0.05 - 0.1 * scale.x;
        EXPECT_NEAR(turned_rad(local[1]), std::atan2(away, scale.y), 1e-6)
            << scale.x << " " << scale.y << " " << scale.z;
    }
}

// ---- Wind

TEST(ProceduralRules, WindBendsABoneByItsSpeedAcrossItAndNotPastItsDirection) {
    const Character character = chain(3);
    struct Case {
        double wind_rad;  // its direction, from the first bone's
        float speed;
    };
    for (const Case& one : {Case{kRightAngle, 4},
                            {kRightAngle, 8},
                            {kRightAngle / 3, 4},
                            {kRightAngle * 5 / 3, 4},
                            {kRightAngle / 3, 100},
                            {kRightAngle, 100}}) {
        const Vec3<double> velocity = Vec3<double>{std::sin(one.wind_rad), std::cos(one.wind_rad), 0} *
                                      double{one.speed};
        const Locals local = moved_by(WindRule{.joint = "joint 1", .bend_rad = 0.05f, .sway_rad = 0}, character,
                                      rest_of(character),
                                      {.world_from_model = {},
                                       .wind = blowing({.velocity = velocity.as<float>(), .gust = 0}),
                                       .instance = 0,
                                       .time_step_s = 1});
        double left_rad = one.wind_rad;  // from the bone to the wind
        for (const uint32_t joint : {1u, 2u}) {
            const double bend_rad = std::min(one.speed * 0.05 * std::sin(left_rad), left_rad);
            EXPECT_NEAR(turned_rad(local[joint]), bend_rad, 1e-6)
                << "joint " << joint << ", wind at " << one.wind_rad << " of " << one.speed;
            left_rad -= bend_rad;
        }
    }
}

// The sway of a joint below joint 1, as a fraction of the maximum. So small that no joint turns into the wind.
double sway(float sway_hz, double time_s, uint32_t instance = 0, uint32_t generation = 0) {
    static const Character character = chain(5);
    constexpr double kSpeed = 2, kSway_rad = 1e-4;
    const WindRule rule{
        .joint = "joint 1", .bend_rad = 0, .sway_rad = static_cast<float>(kSway_rad), .sway_hz = sway_hz};
    const Locals local = moved_by(
        rule, character, rest_of(character),
        {.world_from_model = {},
         .wind = blowing({.velocity = {kSpeed, 0, 0}, .gust = 1}, time_s),  // it sways by the speed without gusts
         .instance = instance,
         .time_step_s = 1.0 / 60});
    return turned_rad(local[1 + generation]) / (kSpeed * kSway_rad);
}

TEST(ProceduralRules, PlantsSwayAtTheirFrequency) {
    // A sway of 4 x (1 - |x|), where x runs from -1 to 1 per cycle
    const std::pair<double, double> cycles_and_places[] = {{0, 0},   {0.0625, -0.4375}, {0.125, -0.75}, {0.25, -1},
                                                           {0.5, 0}, {0.625, 0.75},     {0.75, 1},      {0.875, 0.75}};
    for (const float sway_hz : {0.5f, 2.0f, 8.0f})
        for (const auto& [cycles, place] : cycles_and_places)
            for (const int before : {0, 1, 20})
                EXPECT_NEAR(sway(sway_hz, (before + cycles) / double{sway_hz}), place, 1e-5)
                    << cycles << " of a cycle of " << sway_hz << " Hz after " << before;
    EXPECT_NEAR(sway(2.004f, 10.125), -1, 1e-5) << "of a frequency that is no multiple of 1/64 Hz";
}

TEST(ProceduralRules, SwayRunsOutwardsAndDiffersBetweenInstances) {
    const double golden = (std::sqrt(5.0) - 1) / 2;
    for (const double time_s : {0.25, 0.8}) {
        for (const uint32_t generation : {1u, 3u})
            EXPECT_NEAR(sway(1, time_s, 0, generation), sway(1, time_s - 0.07 * generation), 1e-5) << generation;
        for (const uint32_t instance : {1u, 5u, 1000u})
            EXPECT_NEAR(sway(1, time_s, instance), sway(1, time_s + std::fmod(instance * golden, 1)), 1e-5) << instance;
    }
}

// Gusts with a wavelength of 10 in a wind of 2 units/s pass every 5 s. An eighth of a wavelength along, the three waves
// (the others are 2.7 and 7.1 times shorter) are at 0.75, 0.8775 and -0.6975, which gives 0.49875 by their shares.
TEST(ProceduralRules, GustsTravelWithTheWind) {
    const Character character = chain(2);
    constexpr double kSpeed = 2, kBend_rad = 0.01, kGust = 0.5, kEighth = 0.49875;
    struct Case {
        Vec3<double> instance;  // its position
        double joint_x, time_s, gust;
    };
    for (const Case& one : {Case{{0, 0, 0}, 0, 0, 0},
                            {{1.25, 0, 0}, 0, 0, kEighth},
                            {{0, 0, 0}, 1.25, 0, kEighth},
                            {{-1, 0, 0}, -0.25, 0, -kEighth},
                            {{0, 3, 7}, 0, 0, 0},  // across
                            {{0, 0, 0}, 0, 0.625, -kEighth},
                            {{1, 0, 0}, 0.25, 0.625, 0},  // moving with the wind
                            {{2.5, 0, 0}, 0, 0.625, kEighth}}) {
        Locals local = rest_of(character);
        local[1].translation.x = one.joint_x;
        local = moved_by(WindRule{.joint = "joint 1", .bend_rad = static_cast<float>(kBend_rad), .sway_rad = 0},
                         character, local,
                         {.world_from_model = to_affine(Trs<double>{.translation = one.instance}),
                          .wind = blowing({.velocity = {kSpeed, 0, 0}, .gust = kGust, .wavelength = 10}, one.time_s),
                          .instance = 0,
                          .time_step_s = 1.0 / 60});
        EXPECT_NEAR(turned_rad(local[1]) / (kSpeed * kBend_rad), 1 + kGust * one.gust, 1e-5)
            << one.instance.x << " + " << one.joint_x << " after " << one.time_s << " s";
    }
}

}  // namespace
}  // namespace throng::test
