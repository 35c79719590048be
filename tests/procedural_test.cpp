// Rules that move joints: their plan, what the definition promises, and the kernel against the definition.
#include "blend/blend_reference.h"
#include "crowd/reference.h"
#include "procedural/procedural_reference.h"
#include "sample/sample_reference.h"
#include "tests/crowd_cases.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

namespace throng::test {
namespace {

using Locals = std::vector<Trs<double>>;

// A straight chain up along +y, a unit a bone, beside a first joint that all hang on.
Character chain(uint32_t joint_count) {
    Asset asset = make_asset(
        {.joint_count = joint_count, .shape = RigShape::kChain, .scale_spread = 0, .clip_count = 0});
    Character character = *compile_character(asset);
    for (uint32_t joint = 0; joint < joint_count; ++joint) {
        character.rig.names[joint] = "joint " + std::to_string(joint);
        character.rig.rest[joint] = {.translation = {0, joint == 0 ? 0.0f : 1.0f, 0}};
    }
    return character;
}

Locals rest_of(const Character& character) {
    Locals local;
    for (const Trs<float>& rest : character.rig.rest) local.push_back(rest.as<double>());
    return local;
}

Vec3<double> place_of(const Character& character, const Locals& local, uint32_t joint) {
    const AffineT<double> m = pose_from_local(character, local).model_from_joint[joint];
    return {m.row[0][3], m.row[1][3], m.row[2][3]};
}

WindClock::Moment wind(const Wind& wind, double at_s = 0) {
    WindClock clock;
    clock.set(wind);
    clock.advance(at_s);
    return clock.moment();
}

TEST(ProceduralPlan, ASubtreeBecomesItsLongestChainsInRanks) {
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
    // No chain has the rank of one before it that it touches, or whose joints it hangs on.
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

// A spring that keeps out of what another rule moves comes after it, and before what moves that once more.
TEST(ProceduralPlan, CollidersAreReadWhenTheyStandStill) {
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

TEST(ProceduralPlan, WrongRulesAreRefusedWithTheirNumber) {
    Character character = chain(6);
    character.rig.names[4] = character.rig.names[5] = "twice";
    const std::vector<std::pair<ProceduralRule, const char*>> wrong{
        {WindRule{.joint = "wing"}, "there is no joint 'wing'"},
        {WindRule{.joint = "joint 0", .bend_rad = NAN}, "bend_rad"},
        {WindRule{.joint = "joint 0", .sway_hz = 65}, "sway_hz"},
        {SpringRule{.joint = "joint 0", .frequency_hz = -1}, "frequency_hz"},
        {SpringRule{.joint = "joint 0", .damping = NAN}, "damping"},
        {SpringRule{.joint = "joint 0", .gravity = {0, INFINITY, 0}}, "gravity"},
        {SpringRule{.joint = "joint 0", .radius = -1}, "radius"},
        {SpringRule{.joint = "joint 0", .colliders = {{.joint = "head"}}}, "there is no joint 'head'"},
        {SpringRule{.joint = "joint 0", .colliders = {{.joint = "joint 0", .radius = -1}}}, "collider"},
        {SpringRule{.joint = "joint 0", .colliders = std::vector<Collider>(17, {.joint = "joint 0"})},
         "17 colliders; at most 16"},
        {LookAtRule{.joint = "joint 0", .target = "sun"}, "there is no target 'sun'"},
        {LookAtRule{.joint = "joint 0", .target = "prey", .forward = {0, 0, 0}}, "forward"},
        {LookAtRule{.joint = "joint 0", .target = "prey", .limit_rad = 4}, "limit_rad"},
        {LookAtRule{.joint = "joint 0", .target = "prey", .weight = 2}, "weight"},
        {ReachRule{.joint = "joint 1", .target = "prey"}, "grandparent"},
        {ReachRule{.joint = "joint 3", .target = "prey", .pole = {0, 0, 0}}, "pole"},
        {ReachRule{.joint = "joint 3", .target = "prey", .weight = -1}, "weight"},
        {LookAtRule{.joint = "twice", .target = "prey"}, "there are several joints 'twice'"},
    };
    for (const auto& [rule, what] : wrong) {
        const ProceduralRules rules{.targets = {"prey"}, .rules = {WindRule{.joint = "joint 0"}, rule}};
        const Result<Crowd> crowd = Crowd::create(
            test_device(), {.groups = {{.character = &character, .instance_count = 1, .procedural = &rules}}});
        ASSERT_FALSE(crowd) << what;
        EXPECT_NE(crowd.error().text().find("procedural rule 1"), std::string::npos) << crowd.error().text();
        EXPECT_NE(crowd.error().text().find(what), std::string::npos) << crowd.error().text();
    }
}

TEST(ProceduralReference, WithoutWindNothingBends) {
    const Character character = chain(9);
    const ProceduralRules rules{.targets = {}, .rules = {WindRule{.joint = "joint 0", .sway_rad = 1}}};
    ProceduralReference reference(rules, character);
    Locals local = rest_of(character);
    reference.update(local, {.world_from_model = {}, .wind = {}, .instance = 3, .time_step_s = 1});
    EXPECT_EQ(local, rest_of(character));
}

TEST(ProceduralReference, WindBendsAChainItsWayAndNotPastIt) {
    const Character character = chain(9);
    for (const float strength : {1.0f, 10.0f, 1e6f}) {
        const ProceduralRules rules{.targets = {},
                                    .rules = {WindRule{.joint = "joint 0", .bend_rad = 0.02f, .sway_rad = 0}}};
        ProceduralReference reference(rules, character);
        Locals local = rest_of(character);
        reference.update(local, {.world_from_model = {},
                                 .wind = wind({.velocity = {strength, 0, 0}, .gust = 0}),
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

// The wind's effect is the same however long the crowd has run: its clock keeps its digits.
TEST(ProceduralReference, SwayGoesOnAfterDays) {
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
                                         .wind = wind({.velocity = {5, 0, 5}}, i),
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
    // They lie on it: gravity would have them hang straight down. A bone's length is kept after it was pushed out,
    // which may cost a part of the way.
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

TEST(ProceduralReference, WeightsGoPartOfTheWay) {
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

// A deep limb of a random rig, for rules to move.
struct Limb {
    uint32_t root, parent, end;
};
Limb deepest_limb(const Rig& rig) {
    std::vector<uint32_t> depths(rig.joint_count());
    for (uint32_t joint = 0; joint < rig.joint_count(); ++joint)
        depths[joint] = rig.parents[joint] == kNone ? 0 : depths[rig.parents[joint]] + 1;
    const auto end = static_cast<uint32_t>(std::ranges::max_element(depths) - depths.begin());
    uint32_t root = end;
    while (rig.parents[root] != kNone) root = rig.parents[root];
    return {root, rig.parents[end], end};
}

// Errors of all joints of a crowd's instances that are moved about for a while, sorted. Gently: where a spring's end is
// driven past its joint, the way back is anyone's choice, and float and double choose differently.
std::vector<double> errors(const Character& character, const std::vector<ProceduralRule>& moved_by,
                           const std::string& scan) {
    const ProceduralRules rules{.targets = {"prey", "ledge"}, .rules = moved_by};
    constexpr uint32_t kInstances = 70;
    Crowd crowd = create({.groups = {{.character = &character, .instance_count = 3},
                                     {.character = &character, .instance_count = kInstances, .procedural = &rules}},
                          .scan = scan,
                          .keep_model_matrices = true});
    EXPECT_FALSE(crowd.path(1)->is_fused);
    EXPECT_NE(crowd.path(1)->reason.find("procedural"), std::string::npos) << crowd.path(1)->reason;
    Random random(12);
    std::vector<Playback> playbacks = random_playbacks(random, character, kInstances);
    for (Playback& playback : playbacks)
        playback.first.speed = playback.second.speed = static_cast<float>(random.between(-0.2, 0.2));
    EXPECT_TRUE(crowd.set_playback(3, playbacks));
    std::vector<ProceduralReference> wanted;
    for (uint32_t i = 0; i < kInstances; ++i) wanted.emplace_back(rules, character);
    WindClock clock;
    const double size = character.size;
    std::vector<Vec3<double>> aims;
    for (uint32_t i = 0; i < 2 * kInstances; ++i) aims.push_back(random.vector(3 * size));
    std::vector<double> all;
    for (int update = 0; update < 30; ++update) {
        const auto step_s = static_cast<float>(random.chance(0.1) ? 0 : random.between(0.008, 0.05));
        if (update % 12 == 3) {
            const Wind blows{
                .velocity = random.vector(5).as<float>(), .gust = 0.5f, .wavelength = static_cast<float>(size)};
            EXPECT_TRUE(crowd.set_wind(blows));
            clock.set(blows);
        }
        std::vector<Affine> placements;
        for (uint32_t i = 0; i < kInstances; ++i) {
            placements.push_back(to_affine(Trs<double>{.rotation = axis_angle(Vec3<double>{0, 1, 0}, 0.01 * update + i),
                                                       .translation = {0.004 * size * update, 0, double(i)},
                                                       .scale = {i % 2 == 0 ? 2.0 : -2.0, 2, 2}})
                                     .as<float>());
            const uint32_t target = random.below(2);
            if (update > 0 && random.chance(0.5)) continue;
            const Vec3<float> place = (aims[2 * i + target] + random.vector(0.01 * size)).as<float>();
            const float weight = 0.8f;
            EXPECT_TRUE(crowd.set_target(3 + i, target, place, weight));
            wanted[i].targets[target] = {place.as<double>(), weight};
        }
        EXPECT_TRUE(crowd.set_placement(3, placements));
        EXPECT_TRUE(crowd.update(step_s));
        clock.advance(step_s);
        for (uint32_t i = 0; i < kInstances; ++i) {
            playbacks[i] = advanced(playbacks[i], character, step_s);
            const auto sampled = [&](const ClipPlayback& slot) {
                return slot.clip == kNone
                           ? sample_reference(character, static_cast<uint32_t>(character.clips.size()), 0)
                           : sample_reference(character, slot.clip, slot.time_s);
            };
            Locals local = sampled(playbacks[i].first);
            const Locals second = sampled(playbacks[i].second);
            for (size_t joint = 0; joint < local.size(); ++joint)
                local[joint] = blend_reference(local[joint], second[joint], playbacks[i].weight);
            wanted[i].update(local, {.world_from_model = placements[i].as<double>(),
                                     .wind = clock.moment(),
                                     .instance = 3 + i,
                                     .time_step_s = step_s});
            if (update % 10 != 9) continue;
            const ReferencePose pose = pose_from_local(character, local);
            const std::vector<Affine> got = *crowd.read_model_matrices(3 + i);
            for (size_t joint = 0; joint < got.size(); ++joint)
                all.push_back(matrix_error(got[joint], pose.model_from_joint[joint], size));
        }
    }
    std::ranges::sort(all);
    return all;
}

// Each rule alone, then all one after the other: rounding is what springs on springs with short bones make most of.
void follow(double scale_spread, const std::string& scan) {
    const Character character = make_character(
        {.joint_count = 70, .shape = RigShape::kRandom, .seed = 9, .scale_spread = scale_spread});
    const std::vector<std::string>& names = character.rig.names;
    const Limb limb = deepest_limb(character.rig);
    const std::vector<ProceduralRule> rules{
        LookAtRule{.joint = names[limb.root], .target = "prey", .limit_rad = 1},
        WindRule{.joint = names[limb.root], .bend_rad = 0.05f, .sway_rad = 0.02f, .sway_hz = 1.3f},
        SpringRule{.joint = names[limb.parent],
                   .frequency_hz = 1.5f,
                   .damping = 0.5f,
                   .gravity = {0, -3, 0},
                   .drag = 0.3f,
                   .radius = 0.01f,
                   .colliders = {{.joint = names[limb.root], .a = {0, 0, 0}, .b = {0, 1, 0}, .radius = 0.3f},
                                 {.joint = names[0], .radius = 0.4f}}},
        SpringRule{.joint = names[limb.root], .frequency_hz = 4, .damping = 0.8f},
        ReachRule{.joint = names[limb.end], .target = "ledge", .weight = 0.7f},
        WindRule{.joint = names[limb.end]}};
    const auto expect_few_beyond = [](const std::vector<double>& sorted, double bound, const std::string& what) {
        EXPECT_LE(sorted[sorted.size() * 98 / 100], bound) << what;
        EXPECT_LE(sorted.back(), 0.02) << what;
    };
    for (size_t i = 0; i < rules.size(); ++i) {
        const std::vector<double> alone = errors(character, {rules[i]}, scan);
        if (std::holds_alternative<SpringRule>(rules[i]))
            expect_few_beyond(alone, 2e-5, "rule " + std::to_string(i));
        else
            EXPECT_LE(alone.back(), 1e-4) << "rule " << i;
    }
    expect_few_beyond(errors(character, rules, scan), 1e-4, "all together");
}

TEST(Procedural, MovesJointsAsTheReferenceDoes) { follow(0.1, "auto"); }
TEST(Procedural, MovesSimilaritiesAsTheReferenceDoes) { follow(0, "subgroup_quaternion"); }

// Wind on a chain that is too long for the loops of a software device, or moved whole.
TEST(Procedural, ChainsBeyondTheDevicesLoopsAreRefused) {
    const Character character = make_character(
        {.joint_count = 4000, .shape = RigShape::kChain, .clip_count = 1, .key_count = 2});
    const ProceduralRules rules{
        .targets = {},
        .rules = {SpringRule{.joint = character.rig.names[0],
                             .colliders = std::vector<Collider>(16, {.joint = character.rig.names[0]})}}};
    const Result<Crowd> crowd = Crowd::create(
        test_device(), {.groups = {{.character = &character, .instance_count = 1, .procedural = &rules}}});
    if (crowd) GTEST_SKIP() << "this device ends no loops";
    EXPECT_EQ(crowd.error().code, ErrorCode::kUnsupported);
    EXPECT_NE(crowd.error().text().find("steps"), std::string::npos) << crowd.error().text();
}

// A limb that is hidden by its scale, a target without weight, and one where the joint is: finite, and in place.
TEST(Procedural, LimbsWithoutLengthAndTargetsWithoutWeightChangeNothing) {
    const Character character = chain(6);
    const ProceduralRules rules{
        .targets = {"a", "b"},
        .rules = {ReachRule{.joint = "joint 5", .target = "a"}, LookAtRule{.joint = "joint 1", .target = "a"},
                  ReachRule{.joint = "joint 2", .target = "b"}, SpringRule{.joint = "joint 0"}}};
    Crowd crowd = create({.groups = {{.character = &character, .instance_count = 3, .procedural = &rules}},
                          .keep_model_matrices = true});
    Affine hidden;
    for (auto& row : hidden.row) row = {0, 0, 0, 1};
    ASSERT_TRUE(crowd.set_placement(1, {&hidden, 1}));
    Affine flat;
    flat.row[1] = {0, 0, 0, 0};
    ASSERT_TRUE(crowd.set_placement(2, {&flat, 1}));
    for (uint32_t i = 0; i < 3; ++i) ASSERT_TRUE(crowd.set_target(i, 0, {3, 1, 0}, i == 0 ? 0.0f : 1.0f));
    const std::vector<AffineT<double>> rest = reference_pose(character, {})->model_from_joint;
    // Where it is
    ASSERT_TRUE(
        crowd.set_target(0, 1, Vec3<double>{rest[2].row[0][3], rest[2].row[1][3], rest[2].row[2][3]}.as<float>(), 1));
    ASSERT_TRUE(crowd.update(0.1f));
    for (uint32_t i = 0; i < 3; ++i) {
        const std::vector<Affine> got = *crowd.read_model_matrices(i);
        for (size_t joint = 0; joint < got.size(); ++joint)
            EXPECT_LE(matrix_error(got[joint], rest[joint], character.size), 1e-5)
                << "instance " << i << ", joint " << joint;
    }
}

// A device that dispatches no more than three workgroups: four batches, and chains by threes. The same bits come out.
TEST(Procedural, BatchesAndManyChainsChangeNothing) {
    constexpr uint32_t kInstances = 10;
    const Character character = make_character({.joint_count = 40, .shape = RigShape::kComb, .seed = 5});
    const ProceduralRules rules{
        .targets = {"prey"},
        .rules = {SpringRule{.joint = character.rig.names[0]}, WindRule{.joint = character.rig.names[0]},
                  LookAtRule{.joint = character.rig.names[3], .target = "prey"}}};
    const CrowdSettings settings{
        .groups = {{.character = &character, .instance_count = kInstances, .procedural = &rules}},
        .scan = "serial",
        .keep_model_matrices = true};
    Crowd whole = create(settings);
    Result<Crowd> parts = Crowd::create(device_of_workgroups(3), settings);
    ASSERT_TRUE(parts) << parts.error().text();
    EXPECT_EQ(parts->outputs().size(), 4u);
    Random random(3);
    const std::vector<Playback> playbacks = random_playbacks(random, character, kInstances);
    for (Crowd* crowd : {&whole, &*parts}) {
        ASSERT_TRUE(crowd->set_playback(0, playbacks) && crowd->set_wind({.velocity = {3, 0, 0}}));
        for (uint32_t i = 0; i < kInstances; ++i) ASSERT_TRUE(crowd->set_target(i, 0, {float(i), 2, 3}, 0.5f));
        for (int update = 0; update < 4; ++update) ASSERT_TRUE(crowd->update(0.05f));
    }
    for (uint32_t i = 0; i < kInstances; ++i)
        EXPECT_EQ(*whole.read_model_matrices(i), *parts->read_model_matrices(i)) << i;
}

// Layers, a pose that was set, wind and targets; the reference does it all.
TEST(Procedural, WorksBelowAController) {
    const Character character = make_character({.joint_count = 30, .shape = RigShape::kChain, .seed = 2});
    const ProceduralRules rules{.targets = {"prey"},
                                .rules = {WindRule{.joint = character.rig.names[1]},
                                          LookAtRule{.joint = character.rig.names[3], .target = "prey"}}};
    const Controller controller = direct_layers(1);
    constexpr uint32_t kInstances = 3;
    Crowd crowd = create({.groups = {{.character = &character,
                                      .instance_count = kInstances,
                                      .controller = &controller,
                                      .procedural = &rules,
                                      .pose_capacity = 1}},
                          .keep_model_matrices = true});
    const Wind wind{.velocity = {2, 0, 1}};
    const Affine place = to_affine(Trs<float>{.translation = {1, 2, 3}});
    ASSERT_TRUE(crowd.set_wind(wind) && crowd.set_placement(1, {&place, 1}));
    std::vector<ReferenceCharacter> wanted;
    for (uint32_t i = 0; i < kInstances; ++i) {
        wanted.push_back(std::move(*ReferenceCharacter::create(character, controller, &rules)));
        const LayerPlayback playback{.clip = {.clip = i % 2}};
        ASSERT_TRUE(crowd.play(i, 0, playback) && wanted[i].play(0, playback));
        ASSERT_TRUE(crowd.set_target(i, 0, {3, 4, 5}, 0.7f) && wanted[i].set_target(0, {3, 4, 5}, 0.7f));
        ASSERT_TRUE(wanted[i].set_wind(wind));
        wanted[i].set_placement(i == 1 ? place : Affine{}, true, i);
    }
    const std::vector<Trs<float>> pose(30, Trs<float>{.translation = {0, 1, 0}});
    ASSERT_TRUE(crowd.set_pose(2, pose, 0.5f) && wanted[2].set_pose(pose, 0.5f));
    for (int update = 0; update < 3; ++update) {
        ASSERT_TRUE(crowd.update(0.1f));
        for (uint32_t i = 0; i < kInstances; ++i) {
            ASSERT_TRUE(wanted[i].update(0.1f));
            const std::vector<AffineT<double>> model = wanted[i].pose().model_from_joint;
            const std::vector<Affine> got = *crowd.read_model_matrices(i);
            for (size_t joint = 0; joint < got.size(); ++joint)
                EXPECT_LE(matrix_error(got[joint], model[joint], character.size), 2e-5)
                    << "instance " << i << ", joint " << joint << ", update " << update;
        }
    }
    EXPECT_EQ(wanted[1].placement(), place.as<double>());
    EXPECT_FALSE(wanted[0].set_target(1, {}, 1));
    EXPECT_FALSE(wanted[0].set_wind({.gust = 2}));
    EXPECT_FALSE(ReferenceCharacter::create(character, controller)->set_target(0, {}, 1));
}

TEST(Procedural, WrongTargetsAndPathsAreRefused) {
    const Character character = chain(4);
    const ProceduralRules rules{.targets = {"prey"}, .rules = {LookAtRule{.joint = "joint 1", .target = "prey"}}};
    CrowdSettings settings{.groups = {{.character = &character, .instance_count = 2, .procedural = &rules},
                                      {.character = &character, .instance_count = 1}}};
    Crowd crowd = create(settings);
    EXPECT_FALSE(crowd.set_target(3, 0, {}, 1));
    EXPECT_FALSE(crowd.set_target(2, 0, {}, 1));
    EXPECT_FALSE(crowd.set_target(0, 1, {}, 1));
    EXPECT_FALSE(crowd.set_target(0, 0, {NAN, 0, 0}, 1));
    EXPECT_FALSE(crowd.set_target(0, 0, {}, 1.5f));
    EXPECT_TRUE(crowd.set_target(0, 0, {}, 1));
    EXPECT_FALSE(crowd.set_wind({.velocity = {INFINITY, 0, 0}}));
    EXPECT_FALSE(crowd.set_wind({.gust = 2}));
    EXPECT_FALSE(crowd.set_wind({.wavelength = 0}));
    settings.path = UpdatePath::kFused;
    const Result<Crowd> fused = Crowd::create(test_device(), settings);
    ASSERT_FALSE(fused);
    EXPECT_EQ(fused.error().code, ErrorCode::kUnsupported);
    const ProceduralRules twice{.targets = {"prey", "prey"}, .rules = {}};
    settings = {.groups = {{.character = &character, .instance_count = 2, .procedural = &twice}}};
    const Result<Crowd> two = Crowd::create(test_device(), settings);
    ASSERT_FALSE(two);
    EXPECT_NE(two.error().text().find("two targets 'prey'"), std::string::npos) << two.error().text();
}

}  // namespace
}  // namespace throng::test
