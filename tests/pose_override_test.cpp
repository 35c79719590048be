// Poses that the application sets over the animation, against the reference.
#include "blend/blend_reference.h"
#include "blend/pose_override.h"
#include "reference/reference.h"
#include "sample/sample_reference.h"
#include "tests/crowd_cases.h"
#include "tests/kernel_runner.h"
#include "tests/subset.h"

#include <gtest/gtest.h>

#include <cstdio>

namespace throng::test {
namespace {

const InSubset kPoseOverrideInSubsets({Subset::kGpuAssisted, Subset::kSubgroups},
                                      {"PoseOverride.TwoClipsFollowTheReference"});
const InSubset kPoseOverrideOnOtherDrivers({Subset::kOtherDriver}, {"-PoseOverride.*"});
const InSubset kPoseOverrideNatively({Subset::kNative}, {"PoseOverride.*"});

// The rest pose, bent at all joints; too little to make it ambiguous which way round is shorter.
std::vector<Trs<float>> bent(Random& random, const Character& character) {
    std::vector<Trs<float>> pose = character.rig.rest;
    for (Trs<float>& joint : pose) {
        Trs<double> moved = joint.as<double>();
        moved.rotation = moved.rotation * axis_angle(random.direction(), random.between(0, 0.8));
        // Quaternions may have any length and sign
        const double length = random.between(0.5, 2) * (random.chance(0.5) ? -1 : 1);
        moved.rotation = {moved.rotation.x * length, moved.rotation.y * length, moved.rotation.z * length,
                          moved.rotation.w * length};
        moved.translation = moved.translation + random.vector(0.05);
        moved.scale = moved.scale * random.between(0.9, 1.1);
        joint = moved.as<float>();
    }
    return pose;
}

// Compares bit for bit. If a group is updated in one pass from rows, groups with and without pose capacity have
// different rows or none; their vertices must agree within the bound.
bool same_poses(Crowd& a, uint32_t of_a, Crowd& b, uint32_t of_b, double size) {
    bool has_rows = false;
    for (uint32_t group = 0; a.path(group); ++group) {
        const GroupPath path = *a.path(group);
        has_rows |= path.is_fused && (path.is_native || path.reason != b.path(group)->reason);
    }
    if (!has_rows) return same_bits(*a.read_skin_matrices({of_a}), *b.read_skin_matrices({of_b}));
    return std::ranges::equal(*a.read_positions({of_a}), *b.read_positions({of_b}),
                              [&](const Vec3<float>& x, const Vec3<float>& y) {
                                  return length(x.as<double>() - y.as<double>()) <= kPoseBound * size;
                              });
}

// Two crowds on the settings' update path, one with and one without pose capacity.
struct WithAndWithoutOverrides {
    Crowd overridden, plain;

    explicit WithAndWithoutOverrides(CrowdSettings settings, uint32_t capacity)
        : overridden(create(with(settings, capacity))), plain(create(settings)) {}
    static CrowdSettings with(CrowdSettings settings, uint32_t capacity) {
        for (CrowdGroup& group : settings.groups) group.pose_capacity = capacity;
        return settings;
    }
    bool are_the_same(uint32_t instance, double size) {
        return same_poses(overridden, instance, plain, instance, size);
    }
};

// Set, replaced and cleared at random, with and without fades, among others that are never posed.
void follow_overrides(UpdatePath path, const char* name, double error) {
    constexpr uint32_t kInstances = 30, kOverridden = 12, kUpdates = 60;
    const Character character = creature(60, 15, error);
    const Controller controller = example(name);
    WithAndWithoutOverrides crowds(
        {.groups = {{.character = &character, .instance_count = kInstances, .controller = &controller}},
         .path = path,
         .keep_model_matrices = true},
        kOverridden);
    std::vector<ReferenceCharacter> wanted = references(character, controller, kInstances);
    Random random(23);
    double worst = 0;
    for (uint32_t update = 0; update < kUpdates; ++update) {
        for (uint32_t i = 0; i < kInstances; ++i) {
            const auto [parameter, value] = random_change(random, controller);
            for (Crowd* crowd : {&crowds.overridden, &crowds.plain})
                ASSERT_TRUE(crowd->set_parameter(InstanceHandle{i}, parameter, value));
            ASSERT_TRUE(wanted[i].set_parameter(parameter, value));
        }
        for (uint32_t i = 0; i < kOverridden; ++i) {
            const float fade_s = random.chance(0.3) ? 0 : static_cast<float>(random.between(0, 0.6));
            if (random.chance(0.3)) {
                const std::vector<Trs<float>> pose = bent(random, character);
                ASSERT_TRUE(crowds.overridden.set_pose(InstanceHandle{i}, pose, fade_s));
                ASSERT_TRUE(wanted[i].set_pose(pose, fade_s));
            }
            if (random.chance(0.15)) {
                ASSERT_TRUE(crowds.overridden.clear_pose(InstanceHandle{i}, fade_s));
                ASSERT_TRUE(wanted[i].clear_pose(fade_s));
            }
        }
        const float step_s = random.chance(0.1) ? -0.01f : static_cast<float>(random.between(0, 0.1));
        for (Crowd* crowd : {&crowds.overridden, &crowds.plain}) ASSERT_TRUE(crowd->update(step_s));
        for (ReferenceCharacter& one : wanted) ASSERT_TRUE(one.update(step_s));
        if (update % 5 != 4) continue;
        for (uint32_t i = 0; i < kInstances; ++i)
            worst = std::max(worst, model_error(crowds.overridden, i, wanted[i].pose(), character.size));
        for (uint32_t i = kOverridden; i < kInstances; ++i)
            EXPECT_TRUE(crowds.are_the_same(i, character.size)) << "instance " << i;
    }
    EXPECT_LE(worst, 1e-4);
    std::printf("  %s, %s: largest error %.1e of the size\n", name, path == UpdatePath::kFused ? "fused" : "staged",
                worst);
}

TEST(PoseOverride, ControllersFollowTheReferenceFused) {
    follow_overrides(UpdatePath::kFused, "walker", 1e-4);
    follow_overrides(UpdatePath::kFused, "dragon", 0);
}

TEST(PoseOverride, ControllersFollowTheReferenceStaged) {
    follow_overrides(UpdatePath::kStaged, "walker", 0);
    follow_overrides(UpdatePath::kStaged, "dragon", 1e-4);
}

constexpr uint32_t kAnyNumber = ~0u;

// Characters that play two clips, in several groups and batches, with more poses than one upload chunk holds. `scan`
// may be a method that takes similarities.
void expect_blended(UpdatePath path, const std::string& scan, SkinFormat format, uint32_t max_workgroups) {
    constexpr uint32_t kInstances = 70;
    const Character character = creature(100), other = creature(30, 15, 0);
    const Device device = device_of_workgroups(max_workgroups);
    CrowdSettings settings{.groups = {{.character = &other, .instance_count = 3, .pose_capacity = 1},
                                      {.character = &character, .instance_count = kInstances}},
                           .path = path,
                           .skin_format = format,
                           .scan = scan,
                           .keep_model_matrices = true};
    Result<Crowd> plain = Crowd::create(device, settings);
    ASSERT_TRUE(plain) << plain.error().text();
    settings.groups[1].pose_capacity = kInstances;
    Result<Crowd> crowd = Crowd::create(device, settings);
    ASSERT_TRUE(crowd) << crowd.error().text();
    EXPECT_EQ(crowd->outputs().size() > 2, max_workgroups < kInstances) << "batches";

    Random random(4);
    std::vector<Playback> playbacks = random_playbacks(random, other, 3);
    for (const Playback& playback : random_playbacks(random, character, kInstances)) playbacks.push_back(playback);
    for (Crowd* one : {&*plain, &*crowd}) ASSERT_TRUE(one->set_playback(one->instances(), playbacks));
    constexpr float kFade_s = 0.5f, kStep_s = 0.2f;
    std::vector<std::vector<Trs<float>>> poses(kInstances);
    for (uint32_t i = 0; i < kInstances; ++i) {
        if (i % 7 == 3) continue;
        poses[i] = bent(random, character);
        ASSERT_TRUE(crowd->set_pose(InstanceHandle{3 + i}, poses[i], i % 2 == 0 ? kFade_s : 0));
    }
    for (Crowd* one : {&*plain, &*crowd}) ASSERT_TRUE(one->update(kStep_s));
    PoseFade fade;
    fade.set(kFade_s);
    fade.advance(kStep_s);
    double worst = 0;
    for (uint32_t i = 0; i < kInstances; ++i) {
        if (poses[i].empty()) {
            EXPECT_TRUE(same_poses(*crowd, 3 + i, *plain, 3 + i, character.size)) << "instance " << i;
            continue;
        }
        const Playback playback = advanced(playbacks[3 + i], character, kStep_s);
        const auto sampled = [&](const ClipPlayback& play) {
            return play.clip == kNone ? sample_reference(character, static_cast<uint32_t>(character.clips.size()), 0)
                                      : sample_reference(character, play.clip, play.time_s);
        };
        const std::vector<Trs<double>> first = sampled(playback.first), second = sampled(playback.second),
                                       pose = checked_pose(poses[i], character.rig.joint_count(),
                                                           character.rig.uniform_scale, "pose");
        std::vector<Trs<double>> local;
        for (size_t joint = 0; joint < pose.size(); ++joint)
            local.push_back(blend_reference(pose[joint], blend_reference(first[joint], second[joint], playback.weight),
                                            i % 2 == 0 ? fade.weight() : 1));
        worst = std::max(worst, model_error(*crowd, 3 + i, pose_from_local(character, local), character.size));
    }
    EXPECT_LE(worst, 2 * kPoseBound);
    for (uint32_t i = 0; i < kInstances; ++i) ASSERT_TRUE(crowd->clear_pose(InstanceHandle{3 + i}));
    for (Crowd* one : {&*plain, &*crowd}) ASSERT_TRUE(one->update(kStep_s));
    for (uint32_t i = 0; i < 3 + kInstances; ++i)
        EXPECT_TRUE(same_poses(*crowd, i, *plain, i, character.size)) << "cleared, instance " << i;
    std::printf("  %-20s %s, %zu batches: largest error %.1e of the size\n", crowd->path(1)->scan.method.c_str(),
                crowd->path(1)->is_fused ? "fused" : "staged", crowd->outputs().size(), worst);
}

TEST(PoseOverride, TwoClipsFollowTheReference) {
    expect_blended(UpdatePath::kAuto, "auto", SkinFormat::kAffine, kAnyNumber);
    expect_blended(UpdatePath::kAuto, "auto", SkinFormat::kAffine, 25);
    expect_blended(UpdatePath::kStaged, "auto", SkinFormat::kAffine, 25);
    const std::string similarities = has_scan("subgroup_quaternion") ? "subgroup_quaternion" : "serial_quaternion";
    expect_blended(UpdatePath::kStaged, similarities, SkinFormat::kSimilarity, kAnyNumber);
    expect_blended(UpdatePath::kFused, similarities, SkinFormat::kAffine, kAnyNumber);
    if (has_scan("doubling")) expect_blended(UpdatePath::kFused, "doubling", SkinFormat::kAffine, kAnyNumber);
}

// The same pose gives the same bits, whatever is animated below it.
TEST(PoseOverride, WeightOneShowsThePoseAndZeroTheAnimation) {
    const Character character = creature(60);
    const Controller controller = example("walker");
    Random random(3);
    const std::vector<Trs<float>> pose = bent(random, character);
    for (const UpdatePath path : {UpdatePath::kFused, UpdatePath::kStaged}) {
        WithAndWithoutOverrides crowds(
            {.groups = {{.character = &character, .instance_count = 4},
                        {.character = &character, .instance_count = 4, .controller = &controller}},
             .path = path},
            4);
        const std::vector<Playback> playbacks = random_playbacks(random, character, 4);
        for (Crowd* crowd : {&crowds.overridden, &crowds.plain}) {
            ASSERT_TRUE(crowd->set_playback(*crowd->instances(0), playbacks));
            ASSERT_TRUE(crowd->set_parameter(InstanceHandle{6}, 0, 1.0f));
        }
        const auto update = [&](float step_s) {
            for (Crowd* crowd : {&crowds.overridden, &crowds.plain}) ASSERT_TRUE(crowd->update(step_s));
        };
        for (const uint32_t i : {0u, 2u, 3u, 4u, 6u})
            ASSERT_TRUE(crowds.overridden.set_pose(InstanceHandle{i}, pose, 0.25f));
        update(0);
        for (uint32_t i = 0; i < 8; ++i)
            EXPECT_TRUE(crowds.are_the_same(i, character.size)) << "a fade that has not begun, instance " << i;
        update(0.1f);
        for (const uint32_t i : {0u, 4u, 6u}) EXPECT_FALSE(crowds.are_the_same(i, character.size)) << i;
        update(0.2f);
        for (const uint32_t i : {2u, 3u, 4u, 6u})
            EXPECT_TRUE(same_poses(crowds.overridden, i, crowds.overridden, 0, character.size)) << i;
        for (const uint32_t i : {1u, 5u, 7u}) EXPECT_TRUE(crowds.are_the_same(i, character.size)) << i;
        for (const uint32_t i : {0u, 2u, 3u, 4u, 6u})
            ASSERT_TRUE(crowds.overridden.clear_pose(InstanceHandle{i}, 0.1f));
        update(0.05f);
        EXPECT_FALSE(crowds.are_the_same(0, character.size));
        update(0.06f);
        for (uint32_t i = 0; i < 8; ++i)
            EXPECT_TRUE(crowds.are_the_same(i, character.size)) << "cleared, instance " << i;
    }
}

TEST(PoseOverride, FadesAreEasedAndReverseFromTheirWeight) {
    PoseFade fade;
    fade.advance(1);
    EXPECT_EQ(fade.weight(), 0);
    fade.set(2);
    EXPECT_EQ(fade.weight(), 0);
    fade.advance(0.5f);
    EXPECT_NEAR(fade.weight(), 0.25 * 0.25 * 2.5, 1e-7);
    fade.set(0);  // replaces the pose; the fade continues
    fade.advance(0.5f);
    EXPECT_NEAR(fade.weight(), 0.5, 1e-7);
    fade.clear(1);
    EXPECT_NEAR(fade.weight(), 0.5, 1e-7);
    fade.advance(0.25f);
    EXPECT_NEAR(fade.weight(), 0.25 * 0.25 * 2.5, 1e-7);
    fade.set(1);
    fade.advance(-1);
    EXPECT_NEAR(fade.weight(), 0.25 * 0.25 * 2.5, 1e-7);
    fade.advance(10);
    EXPECT_EQ(fade.weight(), 1);
    EXPECT_FALSE(fade.is_moving());
    fade.clear(1e-40f);
    fade.advance(1e-40f);
    EXPECT_EQ(fade.weight(), 0);
    fade.set(1);
    fade.advance(0.5f);
    fade.clear(0);
    EXPECT_EQ(fade.weight(), 0);
}

TEST(PoseOverride, PoseSlotsAreFreedAfterFadingOut) {
    const Character character = creature(20);
    Crowd crowd = create({.groups = {{.character = &character, .instance_count = 5},
                                     {.character = &character, .instance_count = 5, .pose_capacity = 2}}});
    const std::vector<Trs<float>>& pose = character.rig.rest;
    const auto expect_full = [&](uint32_t instance, const char* capacity) {
        const Result<void> refused = crowd.set_pose(InstanceHandle{instance}, pose);
        ASSERT_FALSE(refused);
        EXPECT_EQ(refused.error().code, ErrorCode::kLimit);
        EXPECT_NE(refused.error().text().find(std::string("all ") + capacity +
                                              " poses of creature (CrowdGroup::pose_capacity)"),
                  std::string::npos)
            << refused.error().text();
    };
    EXPECT_EQ(refusal(crowd.set_pose(InstanceHandle{0}, pose)), "creature: pose: CrowdGroup::pose_capacity is not set");
    ASSERT_TRUE(crowd.clear_pose(InstanceHandle{0}, 1)) << "there is none";
    ASSERT_TRUE(crowd.set_pose(InstanceHandle{5}, pose));
    ASSERT_TRUE(crowd.set_pose(InstanceHandle{9}, pose, 0.5f));
    expect_full(6, "2");
    ASSERT_TRUE(crowd.set_pose(InstanceHandle{5}, pose)) << "replaced";
    ASSERT_TRUE(crowd.update(1));
    ASSERT_TRUE(crowd.clear_pose(InstanceHandle{9}, 0.5f));
    ASSERT_TRUE(crowd.update(0.3f));
    expect_full(6, "2");
    ASSERT_TRUE(crowd.update(0.3f));
    ASSERT_TRUE(crowd.set_pose(InstanceHandle{6}, pose));
    ASSERT_TRUE(crowd.clear_pose(InstanceHandle{5}));
    ASSERT_TRUE(crowd.set_pose(InstanceHandle{7}, pose)) << "free at once";
    expect_full(5, "2");
    ASSERT_TRUE(crowd.update(0.1f));
}

TEST(PoseOverride, WrongPosesAreRefusedAndChangeNothing) {
    const Character character = creature(20), stretched = make_character({.joint_count = 20});
    ASSERT_TRUE(character.rig.uniform_scale);
    ASSERT_FALSE(stretched.rig.uniform_scale);
    const Controller controller = direct_layers(1);
    Crowd crowd = create({.groups = {{.character = &character, .instance_count = 1, .pose_capacity = 9},
                                     {.character = &stretched, .instance_count = 1, .pose_capacity = 1}}});
    ReferenceCharacter reference = std::move(*ReferenceCharacter::create(character, controller));
    const auto expect_refused = [&](std::vector<Trs<float>> pose, float fade_s, const char* why) {
        for (const Result<void>& result :
             {crowd.set_pose(InstanceHandle{0}, pose, fade_s), reference.set_pose(pose, fade_s)}) {
            ASSERT_FALSE(result) << why;
            EXPECT_EQ(result.error().code, ErrorCode::kInvalidArgument);
            EXPECT_NE(result.error().text().find(why), std::string::npos) << result.error().text();
        }
    };
    const auto changed = [&](auto&& change) {
        std::vector<Trs<float>> pose = character.rig.rest;
        change(pose[7]);
        return pose;
    };
    expect_refused({}, 0, "0 transforms for a character that has 20 joints");
    expect_refused(changed([](Trs<float>& t) { t.rotation = {0, 0, 0, 0}; }), 0, "joint 7: its rotation has length 0");
    expect_refused(changed([](Trs<float>& t) { t.translation.y = std::nanf(""); }), 0,
                   "joint 7: a number is not finite");
    expect_refused(changed([](Trs<float>& t) { t.rotation.w = kInfinity; }), 0, "not finite");
    expect_refused(changed([](Trs<float>& t) { t.scale.z = -kInfinity; }), 0, "not finite");
    expect_refused(changed([](Trs<float>& t) { t.scale.z = 1.001f; }), 0, "joint 7: its scale differs along the axes");
    expect_refused(character.rig.rest, -1, "fade");
    expect_refused(character.rig.rest, kInfinity, "fade");
    EXPECT_FALSE(crowd.clear_pose(InstanceHandle{0}, -1));
    EXPECT_FALSE(reference.clear_pose(std::nanf("")));
    EXPECT_FALSE(crowd.set_pose(InstanceHandle{2}, character.rig.rest));
    EXPECT_FALSE(crowd.clear_pose(InstanceHandle{2}));
    EXPECT_TRUE(crowd.set_pose(InstanceHandle{1}, changed([](Trs<float>& t) { t.scale.z = 1.001f; })))
        << "where scales differ anyway";
    EXPECT_TRUE(crowd.set_pose(InstanceHandle{0}, changed([](Trs<float>& t) { t.scale = {1, 1.000001f, 1}; })));
    ASSERT_TRUE(crowd.update(0.1f));
}

}  // namespace
}  // namespace throng::test
