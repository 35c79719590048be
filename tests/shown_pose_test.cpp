// Poses that instances show, as feedback returns them: setting them elsewhere shows the same.
#include "tests/crowd_cases.h"
#include "tests/goldens.h"
#include "tests/lively_crowd.h"
#include "tests/subset.h"

namespace throng::test {
namespace {

const InSubset kShownPoseInSubsets({Subset::kNative}, {"ShownPose.*"});

double furthest(const std::vector<Vec3<float>>& a, const std::vector<Vec3<float>>& b) {
    double most = a.size() == b.size() ? 0 : 1e9;
    for (size_t i = 0; i < std::min(a.size(), b.size()); ++i)
        most = worse_of(most, length(a[i].as<double>() - b[i].as<double>()));
    return most;
}

// Tests random clips in random blends.
void expect_poses_come_back(const Character& character, CrowdSettings settings, double bound) {
    constexpr uint32_t kCount = 6;
    settings.groups = {{.character = &character, .instance_count = kCount, .pose_capacity = kCount}};
    settings.pose_request_capacity = kCount;
    Crowd crowd = create(settings), posed = create(settings);
    Random random(41);
    ASSERT_TRUE(crowd.set_playback(crowd.instances(), random_playbacks(random, character, kCount)));
    ASSERT_TRUE(crowd.update(0.1f) && crowd.request_poses(crowd.instances()) && crowd.update(0.1f));
    const std::vector<Feedback> all = *crowd.feedback();
    ASSERT_EQ(all.size(), 2u);
    EXPECT_TRUE(all[0].poses.empty());
    ASSERT_EQ(all[1].poses.size(), kCount);
    for (const ShownPose& shown : all[1].poses) {
        const Result<void> set = posed.set_pose(shown.instance, shown.parent_from_joint);
        ASSERT_TRUE(set) << refusal(set);
    }
    ASSERT_TRUE(posed.update(0));
    double worst = 0, moved = 0;
    for (uint32_t i = 0; i < kCount; ++i) {
        const std::vector<Vec3<float>> wanted = *crowd.read_positions({i});
        worst = std::max(worst, furthest(wanted, *posed.read_positions({i})) / character.size);
        moved = std::max(moved, furthest(wanted, *crowd.read_positions({0})) / character.size);
    }
    EXPECT_LE(worst, bound) << character.name;
    EXPECT_GT(moved, 1e-3) << character.name;
}

TEST(ShownPose, SetOnAnotherInstanceLooksTheSame) {
    const Character character = creature(60, 15);
    for (const UpdatePath path : {UpdatePath::kAuto, UpdatePath::kStaged})
        for (const SkinFormat format : {SkinFormat::kAffine, SkinFormat::kSimilarity})
            expect_poses_come_back(character, {.path = path, .skin_format = format}, kPoseBound);
    expect_poses_come_back(character, {.skin_format = SkinFormat::kHalfAffine}, 2e-3);
    // Scales of any kind, and mirrored ones
    expect_poses_come_back(make_character({.name = "scaled", .joint_count = 30, .seed = 3, .scale_spread = 0.5}), {},
                           kPoseBound);
}

TEST(ShownPose, IsTheRestPoseWithoutASkin) {
    const Rig rig = creature(8, 4).rig;
    const Character character{
        .name = "bones", .rig = rig, .keys = {{}}, .tracks = std::vector<JointTracks>(8), .size = 1};
    for (const UpdatePath path : {UpdatePath::kAuto, UpdatePath::kDevice}) {
        Crowd crowd = create({.groups = {{.character = &character, .instance_count = 2, .pose_capacity = 2}},
                              .path = path,
                              .pose_request_capacity = 2});
        ASSERT_TRUE(crowd.request_poses(crowd.instances()) && crowd.update(0.1f));
        const Feedback feedback = feedback_of(crowd);
        ASSERT_EQ(feedback.poses.size(), 2u);
        EXPECT_EQ(feedback.poses[1].parent_from_joint.size(), 8u);
    }
}

TEST(ShownPose, SetOnAnotherInstanceLooksTheSameForGoldens) {
    THRONG_SKIP_WITHOUT(shared_folder("goldens"));
    for (const Golden& golden : load_goldens())
        if (!golden.character.clips.empty()) expect_poses_come_back(golden.character, {}, 2e-5);
}

TEST(ShownPose, IsReportedOnceForRequestedInstances) {
    const Character character = creature(20, 5);
    Crowd crowd = create({.groups = {{.character = &character, .instance_count = 2},
                                     {.character = &character, .pose_capacity = 3, .capacity = 3}},
                          .pose_request_capacity = 2});
    const std::vector<InstanceHandle> spawned = *crowd.spawn(1, std::array{Affine{}, Affine{}, Affine{}});
    const auto asked = [&] {
        std::vector<InstanceHandle> instances;
        for (const ShownPose& pose : feedback_of(crowd).poses) {
            instances.push_back(pose.instance);
            EXPECT_EQ(pose.parent_from_joint.size(), 20u);
        }
        return instances;
    };
    ASSERT_TRUE(crowd.request_poses(spawned[2]) && crowd.request_poses(spawned[0]));
    EXPECT_EQ(refusal(crowd.request_poses(spawned[1])),
              "pose request: 3 poses of one update; CrowdSettings::pose_request_capacity is 2");
    ASSERT_TRUE(crowd.update(0));
    EXPECT_EQ(asked(), (std::vector{spawned[2], spawned[0]}));
    ASSERT_TRUE(crowd.update(0));
    EXPECT_EQ(asked(), std::vector<InstanceHandle>());

    // An instance despawned before the update reports no pose. One despawned after it is reported under its old handle.
    ASSERT_TRUE(crowd.request_poses(std::span(spawned).first(2)) && crowd.despawn(std::array{spawned[0]}));
    ASSERT_TRUE(crowd.update(0) && crowd.despawn(std::array{spawned[1]}));
    const std::vector<InstanceHandle> reborn = *crowd.spawn(1, std::array{Affine{}, Affine{}});
    EXPECT_EQ(asked(), std::vector{spawned[1]});

    EXPECT_EQ(refusal(crowd.request_poses(InstanceHandle{0})),
              "pose request: creature has no CrowdGroup::pose_capacity");
    EXPECT_EQ(refusal(crowd.request_poses(spawned[1])), "pose request: instance 3 of generation 0 is not alive");
    ASSERT_TRUE(crowd.update(0));
    EXPECT_EQ(asked(), std::vector<InstanceHandle>()) << "what was refused is not asked";
    Crowd without = create({.groups = {{.character = &character, .instance_count = 1, .pose_capacity = 1}}});
    EXPECT_EQ(without.request_poses(InstanceHandle{0}).error().code, ErrorCode::kLimit);
}

}  // namespace
}  // namespace throng::test
