// Procedural rules: which are refused, and the kernel against the definition.
#include "blend/blend_reference.h"
#include "reference/reference.h"
#include "procedural/procedural_reference.h"
#include "sample/sample_reference.h"
#include "tests/crowd_cases.h"
#include "tests/procedural_cases.h"
#include "tests/subset.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

namespace throng::test {
namespace {

const InSubset kProceduralInSubsets({Subset::kGpuAssisted},
                                    {"Procedural.LimbsWithoutLengthAndTargetsWithoutWeightChangeNothing",
                                     "Procedural.WorksTogetherWithAController"});
const InSubset kProceduralNatively({Subset::kNative},
                                   {"Procedural.*", "-Procedural.ChainsTooLongForTheDevicesLoopsAreRefused"});

TEST(Procedural, WrongRulesAreRefusedWithTheirNumber) {
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
        {SpringRule{.joint = "joint 0", .radius = 1e20f}, "radius must be within 0..1e15"},
        {SpringRule{.joint = "joint 0", .drag = 1e30f}, "drag"},
        {SpringRule{.joint = "joint 0", .colliders = {{.joint = "head"}}}, "there is no joint 'head'"},
        {SpringRule{.joint = "joint 0", .colliders = {{.joint = "joint 0", .radius = -1}}}, "collider"},
        {SpringRule{.joint = "joint 0", .colliders = std::vector<Collider>(17, {.joint = "joint 0"})},
         "17 colliders; at most 16"},
        {LookAtRule{.joint = "joint 0", .target = "sun"}, "there is no target 'sun'"},
        {LookAtRule{.joint = "joint 0", .target = "prey", .forward = {0, 0, 0}}, "forward"},
        {LookAtRule{.joint = "joint 0", .target = "prey", .forward = {1e-30f, 0, 0}}, "forward"},
        {LookAtRule{.joint = "joint 0", .target = "prey", .limit_rad = 4}, "limit_rad"},
        {LookAtRule{.joint = "joint 0", .target = "prey", .weight = 2}, "weight"},
        {ReachRule{.joint = "joint 1", .target = "prey"}, "grandparent"},
        {ReachRule{.joint = "joint 3", .target = "prey", .pole = {0, 0, 0}}, "pole"},
        {ReachRule{.joint = "joint 3", .target = "prey", .weight = -1}, "weight"},
        {LookAtRule{.joint = "twice", .target = "prey"}, "several joints are named 'twice'"},
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

// A limb deep in a random rig, for rules to move.
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

// Sorted errors of all joints of a crowd's instances, which are moved about gently for a while. If a spring's end is
// driven past its joint, the way back is ambiguous, and float and double choose differently.
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
    EXPECT_TRUE(crowd.set_playback(Instances::numbered(3, kInstances), playbacks));
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
            EXPECT_TRUE(crowd.set_target(InstanceHandle{3 + i}, target, {place, weight}));
            wanted[i].targets[target] = {place.as<double>(), weight};
        }
        EXPECT_TRUE(crowd.set_placement(Instances::numbered(3, kInstances), placements));
        EXPECT_TRUE(crowd.update(step_s));
        clock.advance(step_s);
        for (uint32_t i = 0; i < kInstances; ++i) {
            playbacks[i] = advanced(playbacks[i], character, step_s);
            const auto sampled = [&](const ClipPlayback& play) {
                return play.clip == kNone
                           ? sample_reference(character, static_cast<uint32_t>(character.clips.size()), 0)
                           : sample_reference(character, play.clip, play.time_s);
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
            const std::vector<Affine> got = *crowd.read_model_matrices({3 + i});
            for (size_t joint = 0; joint < got.size(); ++joint)
                all.push_back(matrix_error(got[joint], pose.model_from_joint[joint], size));
        }
    }
    std::ranges::sort(all);
    return all;
}

// Each rule alone, then all in sequence. Rounding errors grow most with springs on springs with short bones.
void follow_rules(double scale_spread, const std::string& scan) {
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

TEST(Procedural, MovesJointsAsTheReferenceDoes) { follow_rules(0.1, "auto"); }
TEST(Procedural, MovesSimilaritiesAsTheReferenceDoes) {
    follow_rules(0, has_scan("subgroup_quaternion") ? "subgroup_quaternion" : "serial_quaternion");
}

// A spring chain with so many joints and colliders that a software device's loops cannot process it.
TEST(Procedural, ChainsTooLongForTheDevicesLoopsAreRefused) {
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

// A limb shrunk to nothing, a target without weight, and a target at the joint itself: results are finite and in place.
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
    ASSERT_TRUE(crowd.set_placement(InstanceHandle{1}, hidden));
    Affine flat;
    flat.row[1] = {0, 0, 0, 0};
    ASSERT_TRUE(crowd.set_placement(InstanceHandle{2}, flat));
    for (uint32_t i = 0; i < 3; ++i)
        ASSERT_TRUE(crowd.set_target(InstanceHandle{i}, 0, {{3, 1, 0}, i == 0 ? 0.0f : 1.0f}));
    const std::vector<AffineT<double>> rest = reference_pose(character, {})->model_from_joint;
    // At the joint's own position
    ASSERT_TRUE(crowd.set_target(
        InstanceHandle{0}, 1, {Vec3<double>{rest[2].row[0][3], rest[2].row[1][3], rest[2].row[2][3]}.as<float>(), 1}));
    ASSERT_TRUE(crowd.update(0.1f));
    for (uint32_t i = 0; i < 3; ++i) {
        const std::vector<Affine> got = *crowd.read_model_matrices({i});
        for (size_t joint = 0; joint < got.size(); ++joint)
            EXPECT_LE(matrix_error(got[joint], rest[joint], character.size), 1e-5)
                << "instance " << i << ", joint " << joint;
    }
}

// Exporters write tiny lengths in place of 0: 1e-9 of the size in a knight's toes. Such bones do not swing, and what is
// attached to them behaves as if they had no length.
TEST(Procedural, BonesOfNegligibleLengthAreNotMoved) {
    const auto swung = [](float part) {
        Character character = chain(6);
        for (const uint32_t joint : {3u, 5u}) character.rig.rest[joint].translation.y = part * character.size;
        const ProceduralRules rules{.targets = {}, .rules = {SpringRule{.joint = "joint 0", .gravity = {0.5f, -2, 0}}}};
        Crowd crowd = create({.groups = {{.character = &character, .instance_count = 1, .procedural = &rules}},
                              .keep_model_matrices = true});
        std::vector<Affine> got;
        for (int update = 0; update < 120; ++update) {
            const double angle = 0.05 * update;
            const Trs<double> place{
                axis_angle(Vec3<double>{0, 1, 0}, angle), {std::sin(angle), 0, std::cos(angle)}, {1, 1, 1}};
            EXPECT_TRUE(crowd.set_placement(InstanceHandle{0}, to_affine(place).as<float>()));
            EXPECT_TRUE(crowd.update(1 / 60.0f));
            got = *crowd.read_model_matrices({0});
            for (const Affine& m : got)
                for (const auto& row : m.row)
                    EXPECT_TRUE(std::ranges::all_of(row, [](float value) { return std::isfinite(value); }))
                        << part << ", update " << update;
        }
        return std::pair{got, character.size};
    };
    const auto [without, size] = swung(0);
    EXPECT_GT(std::abs(without[4].row[0][3]), 0.01f * size) << "the others swing";
    for (const float part : {1e-20f, 1e-12f, 1e-9f, 1e-7f, 5e-6f}) {
        const std::vector<Affine> got = swung(part).first;
        for (size_t joint = 0; joint < got.size(); ++joint)
            EXPECT_LE(matrix_error(got[joint], without[joint].as<double>(), size), 1e-4) << part << ", joint " << joint;
    }
}

// Target values as an application's shaders could write them; here the processor writes them.
TEST(Procedural, InvalidTargetValuesHaveNoEffect) {
    const Character character = chain(6);
    const ProceduralRules rules{
        .targets = {"prey"},
        .rules = {ReachRule{.joint = "joint 5", .target = "prey"}, LookAtRule{.joint = "joint 1", .target = "prey"}}};
    Crowd crowd = create({.groups = {{.character = &character, .instance_count = 1, .procedural = &rules}},
                          .keep_model_matrices = true});
    const std::span<std::array<float, 4>> target = crowd.outputs()[0].host.target;
    if (target.empty()) GTEST_SKIP() << "they lie in the device's memory";
    const std::vector<AffineT<double>> rest = reference_pose(character, {})->model_from_joint;
    const float finite[4]{2, 1, 1, 1};
    for (const float wrong : {NAN, INFINITY, -INFINITY, 2e19f})
        for (size_t k = 0; k < 4; ++k) {
            if (k == 3 && wrong > 0) continue;  // a weight of more than 1 counts as 1
            std::ranges::copy(finite, target[0].begin());
            target[0][k] = wrong;
            ASSERT_TRUE(crowd.update(0.1f));
            const std::vector<Affine> got = *crowd.read_model_matrices({0});
            for (size_t joint = 0; joint < got.size(); ++joint)
                EXPECT_LE(matrix_error(got[joint], rest[joint], character.size), 1e-5) << wrong << " at " << k;
        }
}

// A device that dispatches at most three workgroups needs four batches, and processes chains three at a time. The bits
// must be the same.
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
        ASSERT_TRUE(crowd->set_playback(crowd->instances(), playbacks) && crowd->set_wind({.velocity = {3, 0, 0}}));
        for (uint32_t i = 0; i < kInstances; ++i)
            ASSERT_TRUE(crowd->set_target(InstanceHandle{i}, 0, {{float(i), 2, 3}, 0.5f}));
        for (int update = 0; update < 4; ++update) ASSERT_TRUE(crowd->update(0.05f));
    }
    for (uint32_t i = 0; i < kInstances; ++i)
        EXPECT_EQ(*whole.read_model_matrices({i}), *parts->read_model_matrices({i})) << i;
}

// Layers, a pose override, wind and targets together. The reference computes all of it.
TEST(Procedural, WorksTogetherWithAController) {
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
    ASSERT_TRUE(crowd.set_wind(wind) && crowd.set_placement(InstanceHandle{1}, place));
    std::vector<ReferenceCharacter> wanted;
    for (uint32_t i = 0; i < kInstances; ++i) {
        wanted.push_back(std::move(*ReferenceCharacter::create(character, controller, &rules)));
        const LayerPlayback playback{.clip = {.clip = i % 2}};
        ASSERT_TRUE(crowd.play(InstanceHandle{i}, 0, playback) && wanted[i].play(0, playback));
        ASSERT_TRUE(crowd.set_target(InstanceHandle{i}, 0, {{3, 4, 5}, 0.7f}) &&
                    wanted[i].set_target(0, {{3, 4, 5}, 0.7f}));
        ASSERT_TRUE(wanted[i].set_wind(wind));
        wanted[i].set_placement(i == 1 ? place : Affine{}, true, i);
    }
    const std::vector<Trs<float>> pose(30, Trs<float>{.translation = {0, 1, 0}});
    ASSERT_TRUE(crowd.set_pose(InstanceHandle{2}, pose, 0.5f) && wanted[2].set_pose(pose, 0.5f));
    for (int update = 0; update < 3; ++update) {
        ASSERT_TRUE(crowd.update(0.1f));
        for (uint32_t i = 0; i < kInstances; ++i) {
            ASSERT_TRUE(wanted[i].update(0.1f));
            const std::vector<AffineT<double>> model = wanted[i].pose().model_from_joint;
            const std::vector<Affine> got = *crowd.read_model_matrices({i});
            for (size_t joint = 0; joint < got.size(); ++joint)
                EXPECT_LE(matrix_error(got[joint], model[joint], character.size), 2e-5)
                    << "instance " << i << ", joint " << joint << ", update " << update;
        }
    }
    EXPECT_EQ(wanted[1].placement(), place.as<double>());
    EXPECT_FALSE(wanted[0].set_target(1, {}));
    EXPECT_FALSE(wanted[0].set_wind({.gust = 2}));
    EXPECT_FALSE(ReferenceCharacter::create(character, controller)->set_target(0, {}));
}

TEST(Procedural, WrongTargetsAndPathsAreRefused) {
    const Character character = chain(4);
    const ProceduralRules rules{.targets = {"prey"}, .rules = {LookAtRule{.joint = "joint 1", .target = "prey"}}};
    CrowdSettings settings{.groups = {{.character = &character, .instance_count = 2, .procedural = &rules},
                                      {.character = &character, .instance_count = 1}}};
    Crowd crowd = create(settings);
    EXPECT_FALSE(crowd.set_target(InstanceHandle{3}, 0, {{}, 1}));
    EXPECT_FALSE(crowd.set_target(InstanceHandle{2}, 0, {{}, 1}));
    EXPECT_FALSE(crowd.set_target(InstanceHandle{0}, 1, {{}, 1}));
    EXPECT_FALSE(crowd.set_target(InstanceHandle{0}, 0, {{NAN, 0, 0}, 1}));
    EXPECT_FALSE(crowd.set_target(InstanceHandle{0}, 0, {{0, 2e19f, 0}, 1}));
    EXPECT_FALSE(crowd.set_target(InstanceHandle{0}, 0, {{}, 1.5f}));
    EXPECT_TRUE(crowd.set_target(InstanceHandle{0}, 0, {{}, 1}));
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
    EXPECT_NE(two.error().text().find("two targets are named 'prey'"), std::string::npos) << two.error().text();
}

}  // namespace
}  // namespace throng::test
