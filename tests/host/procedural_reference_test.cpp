// Procedural rules: the order in which they are planned, and guarantees of the reference.
#include "tests/procedural_cases.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

namespace throng::test {
namespace {

TEST(ProceduralPlan, ASubtreeIsSplitIntoItsLongestChains) {
    Character character = make_character({.joint_count = 31, .shape = RigShape::kBinary});
    const ProceduralRules rules{
        .targets = {},
        .rules = {WindRule{.joint = character.rig.names[0]}, SpringRule{.joint = character.rig.names[1]}}};
    const ProceduralPlan plan = plan_procedural(rules, character);
    for (uint32_t rule = 0; rule < 2; ++rule) {
        std::vector<uint32_t> seen;
        for (const PlannedChain& chain : plan.chains) {
            if (chain.rule != rule) continue;
            seen.insert(seen.end(), chain.joints.begin(), chain.joints.end());
            for (size_t k = 1; k < chain.joints.size(); ++k)
                EXPECT_EQ(character.rig.parents[chain.joints[k]], chain.joints[k - 1]);
        }
        std::ranges::sort(seen);
        EXPECT_EQ(std::ranges::adjacent_find(seen), seen.end()) << "a joint is in two chains";
        EXPECT_EQ(seen.size(), rule == 0 ? 31u : 15u);
    }
    EXPECT_EQ(plan.chains[0].joints.size(), 5u);
    EXPECT_EQ(plan.spring_count, 15u);
    // No two chains of the same rank touch each other, or depend on each other's joints.
    for (size_t b = 0; b < plan.chains.size(); ++b)
        for (size_t a = 0; a < b; ++a) {
            const auto touches = [&](const PlannedChain& reader, const PlannedChain& writer) {
                for (uint32_t joint = reader.joints.back(); joint != kNone; joint = character.rig.parents[joint])
                    if (std::ranges::find(writer.joints, joint) != writer.joints.end()) return true;
                return false;
            };
            const bool are_apart = !touches(plan.chains[b], plan.chains[a]) && !touches(plan.chains[a], plan.chains[b]);
            EXPECT_TRUE(are_apart || plan.chains[b].rank > plan.chains[a].rank) << a << ", " << b;
        }
}

// A spring must come after the rule that moves its collider, and before a rule that moves the collider again.
TEST(ProceduralPlan, CollidersAreReadBetweenRulesThatMoveThem) {
    const Character character = make_character({.joint_count = 31, .shape = RigShape::kBinary});
    const auto child_from = [&](size_t first) {
        return static_cast<size_t>(std::find(character.rig.parents.begin() + static_cast<std::ptrdiff_t>(first),
                                             character.rig.parents.end(), 0u) -
                                   character.rig.parents.begin());
    };
    const size_t collider = child_from(0), springy = child_from(collider + 1);  // both hang on the first joint
    const std::vector<std::string>& names = character.rig.names;
    const WindRule moves{.joint = names[collider]};
    const ProceduralRules rules{
        .targets = {},
        .rules = {moves, SpringRule{.joint = names[springy], .colliders = {{.joint = names[collider]}}}, moves}};
    const ProceduralPlan plan = plan_procedural(rules, character);
    const auto ranks_of = [&](uint32_t rule, bool moves_collider) {
        std::vector<uint32_t> ranks;
        for (const PlannedChain& chain : plan.chains)
            if (chain.rule == rule &&
                (!moves_collider || std::ranges::find(chain.joints, collider) != chain.joints.end()))
                ranks.push_back(chain.rank);
        return ranks;
    };
    const std::vector<uint32_t> before = ranks_of(0, true), springs = ranks_of(1, false), after = ranks_of(2, true);
    ASSERT_EQ(before.size(), 1u);
    ASSERT_EQ(after.size(), 1u);
    for (const uint32_t rank : springs)
        EXPECT_TRUE(before[0] < rank && rank < after[0]) << before[0] << ", " << rank << ", " << after[0];
}

TEST(ProceduralReference, WithoutWindNothingBends) {
    const Character character = chain(9);
    const ProceduralRules rules{.targets = {}, .rules = {WindRule{.joint = "joint 0", .sway_rad = 1}}};
    ProceduralReference reference(rules, character);
    Locals local = rest_of(character);
    reference.update(local, {.world_from_model = {}, .wind = {}, .instance = 3, .time_step_s = 1});
    EXPECT_EQ(local, rest_of(character));
}

TEST(ProceduralReference, WindBendsAChainUpToItsDirection) {
    const Character character = chain(9);
    for (const float strength : {1.0f, 10.0f, 1e6f}) {
        const ProceduralRules rules{.targets = {},
                                    .rules = {WindRule{.joint = "joint 0", .bend_rad = 0.02f, .sway_rad = 0}}};
        ProceduralReference reference(rules, character);
        Locals local = rest_of(character);
        reference.update(local, {.world_from_model = {},
                                 .wind = blowing({.velocity = {strength, 0, 0}, .gust = 0}),
                                 .instance = 0,
                                 .time_step_s = 1});
        const Vec3<double> tip = place_of(character, local, 8);
        EXPECT_GT(tip.x, 0.05) << strength;
        EXPECT_GT(tip.y, -1e-9) << strength;
        EXPECT_NEAR(tip.z, 0, 1e-9) << strength;
        if (strength == 1e6f) {
            EXPECT_NEAR(tip.x, 8, 1e-6);
        }
    }
}

// Sway is equally precise however long the crowd has run: the wind clock keeps its precision.
TEST(ProceduralReference, SwayStaysPreciseAfterDays) {
    WindClock clock;
    clock.set({.velocity = {1, 0, 0}, .gust = 1, .wavelength = 0.3f});
    for (int i = 0; i < 1000; ++i) clock.advance(1000.25);
    EXPECT_GE(clock.moment().sway_time_s, 0);
    EXPECT_LT(clock.moment().sway_time_s, 64);
    EXPECT_NEAR(std::remainder(clock.moment().sway_time_s - 1000 * 1000.25, 64), 0, 1e-6);
    for (const double phase : clock.moment().gust_phases) EXPECT_TRUE(phase >= 0 && phase < 1) << phase;
}

TEST(ProceduralReference, SpringsComeToRestWhereThePoseHasThem) {
    const Character character = chain(6);
    const ProceduralRules rules{.targets = {},
                                .rules = {SpringRule{.joint = "joint 0", .frequency_hz = 3, .damping = 0.5f}}};
    ProceduralReference reference(rules, character);
    AffineT<double> placement;
    Locals local;
    double furthest = 0;
    for (int i = 0; i < 600; ++i) {
        local = rest_of(character);
        if (i == 100) placement.row[0][3] = 2;  // a jerk
        reference.update(local, {.world_from_model = placement, .wind = {}, .instance = 0, .time_step_s = 1.0 / 60});
        furthest = std::max(furthest, std::abs(place_of(character, local, 5).x));
    }
    EXPECT_GT(furthest, 0.5);
    EXPECT_NEAR(length(place_of(character, local, 5) - place_of(character, rest_of(character), 5)), 0, 1e-4);
}

TEST(ProceduralReference, SpringsAreStableAtAnyTimeStep) {
    const Character character = chain(12);
    for (const float frequency_hz : {0.0f, 1.0f, 30.0f, 1000.0f})
        for (const float damping : {0.0f, 0.3f, 5.0f}) {
            const ProceduralRules rules{
                .targets = {},
                .rules = {SpringRule{
                    .joint = "joint 2",
                    .frequency_hz = frequency_hz,
                    .damping = damping,
                    .gravity = {0, -10, 0},
                    .drag = 1,
                    .colliders = {{.joint = "joint 1", .a = {0.3f, 0, 0}, .b = {0.3f, 5, 0}, .radius = 0.25f}}}}};
            ProceduralReference reference(rules, character);
            Random random(7);
            AffineT<double> placement;
            for (int i = 0; i < 2000; ++i) {
                Locals local = rest_of(character);
                placement.row[0][3] = random.between(-3, 3);
                const double step_s = std::pow(10, random.between(-6, 2));
                reference.update(local, {.world_from_model = placement,
                                         .wind = blowing({.velocity = {5, 0, 5}}, i),
                                         .instance = 0,
                                         .time_step_s = random.chance(0.1) ? 0 : step_s});
                const ReferencePose pose = pose_from_local(character, local);
                for (const AffineT<double>& m : pose.model_from_joint)
                    for (const auto& row : m.row)
                        for (const double number : row)
                            ASSERT_TRUE(std::isfinite(number) && std::abs(number) < 13)
                                << frequency_hz << " Hz, damping " << damping << ", update " << i;
            }
        }
}

TEST(ProceduralReference, SpringsStayOutOfColliders) {
    const Character character = chain(8);
    const Collider capsule{.joint = "joint 0", .a = {0.2f, -9, -3}, .b = {0.2f, -9, 3}, .radius = 8.5f};
    const ProceduralRules rules{.targets = {},
                                .rules = {SpringRule{.joint = "joint 0",
                                                     .frequency_hz = 0.5f,
                                                     .damping = 1,
                                                     .gravity = {2, -30, 0},
                                                     .radius = 0.05f,
                                                     .colliders = {capsule}}}};
    ProceduralReference reference(rules, character);
    Locals local;
    for (int i = 0; i < 2000; ++i) {
        local = rest_of(character);
        reference.update(local, {.world_from_model = {}, .wind = {}, .instance = 0, .time_step_s = 1.0 / 60});
    }
    // The joints lie on the collider; without it, gravity would make them hang straight down. After a joint is pushed
    // out, its bone's length is restored, which may undo a part of the push.
    for (uint32_t joint = 1; joint < 8; ++joint) {
        const Vec3<double> at = place_of(character, local, joint);
        EXPECT_GT(std::hypot(at.x - 0.2, at.y + 9), 8.55 * 0.98) << "joint " << joint;
    }
    EXPECT_LT(place_of(character, local, 7).y, 3);
}

TEST(ProceduralReference, LookAtPointsAtItsTargetWithinItsLimit) {
    const Character character = chain(5);
    Random random(3);
    for (int i = 0; i < 500; ++i) {
        const float limit_rad = static_cast<float>(random.between(0, 3.1));
        const ProceduralRules rules{
            .targets = {"prey"},
            .rules = {LookAtRule{.joint = "joint 4", .target = "prey", .forward = {0, 0, 2}, .limit_rad = limit_rad}}};
        ProceduralReference reference(rules, character);
        const Trs<double> placement = random.trs(5, 0);
        reference.targets[0] = {random.vector(20), 1};
        Locals local = rest_of(character);
        for (Trs<double>& joint : local) joint.rotation = random.rotation();
        const auto forward = [&] {
            return normalized(transform_vector(
                to_affine(placement) * pose_from_local(character, local).model_from_joint[4], Vec3<double>{0, 0, 1}));
        };
        const Vec3<double> before = forward();
        reference.update(local,
                         {.world_from_model = to_affine(placement), .wind = {}, .instance = 0, .time_step_s = 0});
        const Vec3<double> to_target = normalized(reference.targets[0].place -
                                                  transform_point(to_affine(placement), place_of(character, local, 4)));
        const double asked_rad = std::acos(std::clamp(dot(before, to_target), -1.0, 1.0)),
                     left_rad = std::acos(std::clamp(dot(forward(), to_target), -1.0, 1.0));
        EXPECT_NEAR(left_rad, std::max(asked_rad - limit_rad, 0.0), 1e-6);
    }
}

TEST(ProceduralReference, ReachPutsTheJointAtItsTargetOrAsNearAsItGets) {
    const Character character = chain(6);
    Random random(4);
    for (int i = 0; i < 1000; ++i) {
        const ProceduralRules rules{.targets = {"ledge"}, .rules = {ReachRule{.joint = "joint 5", .target = "ledge"}}};
        ProceduralReference reference(rules, character);
        Locals local = rest_of(character);
        for (Trs<double>& joint : local) {
            joint.rotation = i % 4 == 0 ? Quaternion<double>{} : random.rotation();  // straight limbs too
            joint.translation = joint.translation * random.between(0.5, 2);
        }
        const Vec3<double> shoulder = place_of(character, local, 3);
        const double upper = length(local[4].translation), lower = length(local[5].translation);
        reference.targets[0] = {shoulder + random.direction() * random.between(0.1, 5), 1};
        reference.update(local, {.world_from_model = {}, .wind = {}, .instance = 0, .time_step_s = 0});
        const double wanted = length(reference.targets[0].place - shoulder),
                     reached = std::clamp(wanted, std::abs(upper - lower), upper + lower);
        const Vec3<double> at = place_of(character, local, 5);
        EXPECT_NEAR(length(at - (shoulder + normalized(reference.targets[0].place - shoulder) * reached)), 0, 1e-6)
            << i;
        EXPECT_NEAR(length(place_of(character, local, 4) - shoulder), upper, 1e-9);
    }
}

TEST(ProceduralReference, PartialWeightsMovePartOfTheWay) {
    const Character character = chain(6);
    const auto end_with = [&](double target_weight, float rule_weight) {
        const ProceduralRules rules{.targets = {"a"},
                                    .rules = {ReachRule{.joint = "joint 5", .target = "a", .weight = rule_weight},
                                              LookAtRule{.joint = "joint 1", .target = "a", .weight = rule_weight}}};
        ProceduralReference reference(rules, character);
        Locals local = rest_of(character);
        reference.targets[0] = {{1, 4, 0}, target_weight};
        reference.update(local, {.world_from_model = {}, .wind = {}, .instance = 0, .time_step_s = 0});
        return place_of(character, local, 5);
    };
    const Vec3<double> rest = place_of(character, rest_of(character), 5);
    EXPECT_NEAR(length(end_with(0, 1) - rest), 0, 1e-9);
    EXPECT_NEAR(length(end_with(1, 0) - rest), 0, 1e-9);
    EXPECT_NEAR(length(end_with(0.5, 1) - end_with(1, 0.5f)), 0, 1e-9);
    EXPECT_GT(length(end_with(0.5, 1) - rest), 0.1);
}

TEST(ProceduralPlan, TargetsAreFoundByTheirNames) {
    const ProceduralRules rules{.targets = {"eye", "hand"}};
    EXPECT_EQ(rules.find_target("hand"), 1u);
    EXPECT_EQ(rules.find_target("foot"), kNone);
}

}  // namespace
}  // namespace throng::test
