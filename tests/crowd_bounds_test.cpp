// A crowd's bounds, to which pictures are fitted: they follow where updates move instances, and a few outliers do not
// distort them.
#include "draw/crowd_bounds.h"
#include "tests/crowd_cases.h"
#include "tests/kernel_runner.h"
#include "tests/recorder.h"
#include "tests/subset.h"

#include <gtest/gtest.h>

namespace throng::test {
namespace {

const InSubset kCrowdBoundsNatively({Subset::kNative}, {"CrowdBoundsTest.*"});

constexpr uint32_t kCrowdBoundsCount = 12;

// In a row, 1 unit apart, each of size 1.
std::vector<Affine> in_a_row(uint32_t count) {
    std::vector<Affine> places;
    for (uint32_t i = 0; i < count; ++i) places.push_back(placed_at(static_cast<float>(i)));
    return places;
}

// Agents without root motion, which walk as fast as they want.
Crowd crowd_of_agents(const Character& character, UpdatePath path = UpdatePath::kAuto) {
    Crowd crowd = create({.groups = {{.character = &character,
                                      .instance_count = kCrowdBoundsCount,
                                      .steering = Steering{.radius = 0.1f, .speed = 5},
                                      .capacity = kCrowdBoundsCount + 4}},
                          .path = path,
                          .culling = Culling{}});
    EXPECT_TRUE(crowd.set_placement(Instances::numbered(0, kCrowdBoundsCount), in_a_row(kCrowdBoundsCount)));
    for (uint32_t i = 0; i < kCrowdBoundsCount; ++i)
        EXPECT_TRUE(crowd.set_destination(InstanceHandle{i}, Vec3<float>{static_cast<float>(i), 0, 100}));
    return crowd;
}

// Reads the placements that the update has left on the device.
float farthest_z(const Crowd& crowd) {
    float z = -1e30f;
    for (const Affine& place : output<Affine>(crowd.outputs()[0], &OutputBlock::placement, kCrowdBoundsCount))
        z = std::max(z, place.row[2][3]);
    return z;
}

// Agents turn, and the rest pose's box turns with them, but too little to matter here.
float middle_z(const Bounds& bounds) { return (bounds.min.z + bounds.max.z) / 2; }

bool same(const Bounds& a, const Bounds& b) { return length(a.min - b.min) == 0 && length(a.max - b.max) == 0; }

class CrowdBoundsTest : public testing::Test {
protected:
    const Character character_ = creature(20, 6);
    Renderer renderer_ = Renderer::create(test_device(), {.width = 64, .height = 48}).value();
};

TEST_F(CrowdBoundsTest, FollowWhereUpdatesMoveInstances) {
    const float reach = 2 * character_.size;
    for (const bool prepared_before : {true, false}) {
        SCOPED_TRACE(prepared_before);
        Crowd crowd = crowd_of_agents(character_);
        ASSERT_TRUE(!prepared_before || renderer_.prepare(crowd));
        for (int update = 0; update < 120; ++update) ASSERT_TRUE(crowd.update(0.1f));
        const float z = farthest_z(crowd);
        ASSERT_GT(z, 5);
        if (!prepared_before) {
            EXPECT_LT(world_bounds(crowd).max.z, reach) << "nobody has asked for it";
            ASSERT_TRUE(renderer_.prepare(crowd));
        }
        EXPECT_NEAR(middle_z(world_bounds(crowd)), z, reach);

        // A placement that the application sets counts at once, before the device reports the last update. The bounds
        // of the others stay.
        ASSERT_TRUE(crowd.update(0.1f));
        ASSERT_TRUE(crowd.set_placement(InstanceHandle{3}, placed_at(3, 0, -50)));
        EXPECT_LT(world_bounds(crowd).min.z, -49);
        EXPECT_NEAR(world_bounds(crowd).max.z, z, reach);
        ASSERT_TRUE(crowd.update(0.1f));
        EXPECT_LT(world_bounds(crowd).min.z, -40);
        EXPECT_GT(world_bounds(crowd).max.z, z);

        // A new instance, where none has been before.
        ASSERT_TRUE(crowd.despawn(std::vector{InstanceHandle{3}}));
        const auto spawned = crowd.spawn(0, std::vector{placed_at(80, 0, z)}).value();
        EXPECT_NEAR(world_bounds(crowd).max.x, 80, reach);
        EXPECT_GT(world_bounds(crowd).min.z, z - reach);
    }
}

TEST_F(CrowdBoundsTest, FollowAfterASaveBeforeTheFirstUpdate) {
    for (const UpdatePath path : {UpdatePath::kAuto, UpdatePath::kDevice}) {
        Crowd crowd = crowd_of_agents(character_, path);
        ASSERT_TRUE(crowd.save_state());
        for (int update = 0; update < 150; ++update) ASSERT_TRUE(crowd.update(0.1f));
        ASSERT_TRUE(renderer_.prepare(crowd));
        const float z = farthest_z(crowd), reach = 2 * character_.size;
        EXPECT_GT(z, reach);
        EXPECT_NEAR(middle_z(world_bounds(crowd)), z, reach);
    }
}

TEST_F(CrowdBoundsTest, FollowRecordedUpdatesAndNotDiscardedOnes) {
    if (test_gpu()->is_native()) GTEST_SKIP() << "it has no command buffers";
    Crowd crowd = crowd_of_agents(character_);
    ASSERT_TRUE(renderer_.prepare(crowd));
    Recorder recorder;
    const auto update = [&](bool runs) {
        const VkCommandBuffer commands = recorder.record(
            [&](VkCommandBuffer into) { ASSERT_TRUE(crowd.record(into, 0.1f)); });
        if (runs) {
            recorder.submit(commands);
            test_gpu()->wait_idle();
        } else {
            EXPECT_TRUE(crowd.discard_last_record());
        }
    };
    for (int i = 0; i < 120; ++i) update(i % 3 < 2);
    const float z = farthest_z(crowd), ahead = z - middle_z(world_bounds(crowd));
    ASSERT_GT(z, 5);
    EXPECT_LT(std::abs(ahead), 2 * character_.size);

    // Updates that never run and are not discarded either.
    for (int i = 0; i < 3; ++i) recorder.record([&](VkCommandBuffer into) { ASSERT_TRUE(crowd.record(into, 0.1f)); });
    for (int i = 0; i < 30; ++i) update(true);
    EXPECT_GT(farthest_z(crowd), z + 1);
    constexpr float kStep = 0.1f;  // of an update
    EXPECT_NEAR(middle_z(world_bounds(crowd)) + ahead, farthest_z(crowd), kStep / 4) << "the last one";
}

// Recorded frames do not wait to learn where a crowd had moved before: they learn it from the updates that follow.
// prepare() waits.
TEST_F(CrowdBoundsTest, FollowACrowdThatHadMovedBefore) {
    if (test_gpu()->is_native()) GTEST_SKIP() << "it has no command buffers";
    Renderer renderer = Renderer::create(test_device(), {.width = 64, .height = 48, .path = DrawPath::kDevice}).value();
    Crowd learning = crowd_of_agents(character_), told = crowd_of_agents(character_);
    for (int update = 0; update < 500; ++update)
        for (Crowd* const crowd : {&learning, &told}) ASSERT_TRUE(crowd->update(0.1f));
    const float z = farthest_z(told), reach = 2 * character_.size;
    ASSERT_GT(z, 2 * reach);
    Recorder recorder;
    const auto record = [&](Crowd& crowd) {
        return recorder.record([&](VkCommandBuffer into) {
            EXPECT_TRUE(renderer.record(into, crowd, 0.1f, {.eye = {6, 4, 14}}));
        });
    };
    const uint64_t submissions = test_gpu()->counts.submissions;
    const VkCommandBuffer commands = record(learning);
    record(told);
    EXPECT_EQ(test_gpu()->counts.submissions, submissions);
    EXPECT_LT(world_bounds(learning).max.z, reach) << "nothing has arrived";
    recorder.submit(commands);
    test_gpu()->wait_idle();
    EXPECT_NEAR(middle_z(world_bounds(learning)), z, reach);

    EXPECT_LT(world_bounds(told).max.z, reach);
    ASSERT_TRUE(told.discard_last_record());
    ASSERT_TRUE(renderer.prepare(told));
    EXPECT_NEAR(middle_z(world_bounds(told)), z, reach);
}

// Nothing has been uploaded to the device yet.
TEST_F(CrowdBoundsTest, IgnoreUpdatesThatHaveNotRun) {
    if (test_gpu()->is_native()) GTEST_SKIP() << "it has no command buffers";
    Crowd crowd = crowd_of_agents(character_);
    ASSERT_TRUE(crowd.set_placement(Instances::numbered(0, kCrowdBoundsCount), placed_at(500, 0, 500)));
    Recorder recorder;
    recorder.record([&](VkCommandBuffer commands) { ASSERT_TRUE(crowd.record(commands, 0.1f)); });
    ASSERT_TRUE(renderer_.prepare(crowd));
    EXPECT_GT(world_bounds(crowd).min.z, 500 - 2 * character_.size);
}

// Bounds are first asked for after a change. They know where earlier updates have moved instances, even if groups were
// added or a state was restored since, and where an added group has been placed.
TEST_F(CrowdBoundsTest, AreRightIfFirstReadAfterAChange) {
    const auto moved = [&] {
        Crowd crowd = crowd_of_agents(character_);
        for (int i = 0; i < 30; ++i) EXPECT_TRUE(crowd.update(0.1f));
        return crowd;
    };
    Crowd wanted = moved(), grown = moved(), restored = crowd_of_agents(character_),
          shown = crowd_of_agents(character_);
    ASSERT_TRUE(renderer_.prepare(wanted));
    const Bounds bounds = world_bounds(wanted);
    ASSERT_GT(bounds.max.z, 4);
    Crowd others = crowd_of_agents(character_);
    ASSERT_TRUE(others.set_placement(Instances::numbered(0, kCrowdBoundsCount), placed_at(0, 0, 2)));
    ASSERT_TRUE(others.clear_destination(Instances::numbered(0, kCrowdBoundsCount)));
    ASSERT_TRUE(grown.add_groups(std::move(others)));
    ASSERT_TRUE(
        wanted.add_groups(create({.groups = {{.character = &character_, .instance_count = 1}}, .culling = Culling{}})));
    EXPECT_TRUE(wanted.state().placements->is_followed()) << "on, without waiting for it again";
    ASSERT_TRUE(wanted.remove_group(1));
    EXPECT_EQ(world_bounds(wanted).max.z, bounds.max.z);
    ASSERT_TRUE(renderer_.prepare(shown));
    for (int i = 0; i < 3; ++i) ASSERT_TRUE(shown.update(0.1f));
    for (Crowd* const one : {&restored, &shown}) ASSERT_TRUE(one->restore_state(wanted.save_state().value()));
    for (Crowd* const one : {&grown, &restored, &shown}) {
        ASSERT_TRUE(renderer_.prepare(*one));
        EXPECT_EQ(world_bounds(*one).max.z, bounds.max.z);
    }
    for (int i = 0; i < 20; ++i)
        for (Crowd* const one : {&wanted, &grown, &restored, &shown}) ASSERT_TRUE(one->update(0.1f));
    EXPECT_GT(world_bounds(wanted).max.z, bounds.max.z + 1);
    for (Crowd* const one : {&grown, &restored, &shown})
        EXPECT_EQ(world_bounds(*one).max.z, world_bounds(wanted).max.z);
}

TEST_F(CrowdBoundsTest, LeaveOutOutliersButNotAGroup) {
    constexpr uint32_t kMany = 300;
    Crowd crowd = create({.groups = {{.character = &character_, .instance_count = kMany}}});
    std::vector<Affine> places = in_a_row(kMany);
    ASSERT_TRUE(crowd.set_placement(crowd.instances(), places));
    const Bounds all = world_bounds(crowd);
    EXPECT_TRUE(same(main_bounds(crowd), all));
    // One that falls through the ground, one that flies, one far away.
    places[7] = placed_at(7, -1e6f);
    places[8] = placed_at(8, 1e5f);
    places[9] = placed_at(9, 0, 1e7f);
    ASSERT_TRUE(crowd.set_placement(crowd.instances(), places));
    EXPECT_TRUE(same(main_bounds(crowd), all));
    EXPECT_LT(world_bounds(crowd).min.y, -9e5f);
    EXPECT_NEAR(bounds_of(std::array{&crowd.state()}, Outliers::kLeftOut).ground, all.min.y, character_.size);
    places[10] = placed_at(10, 0, 1e7f);  // more than one in a hundred
    ASSERT_TRUE(crowd.set_placement(crowd.instances(), places));
    EXPECT_TRUE(same(main_bounds(crowd), world_bounds(crowd)));
}

TEST_F(CrowdBoundsTest, CharacterSizeIsThatOfALivingInstance) {
    Crowd crowd = create({.groups = {{.character = &character_, .instance_count = 1},
                                     {.character = &character_, .instance_count = 1, .capacity = 4}}});
    const auto size = [&] { return character_size(std::array{&crowd.state()}) / character_.size; };
    const float usual = size();
    const InstanceHandle large{1};
    ASSERT_TRUE(crowd.set_placement(large, to_affine(Trs<float>{.scale = {3, 3, 3}})));
    EXPECT_NEAR(size(), 3 * usual, 1e-3f);
    ASSERT_TRUE(crowd.despawn(large));
    EXPECT_NEAR(size(), usual, 1e-3f);
}

// Motion-capture files have the hips at the origin in the rest pose, but the feet on the ground in all clips.
TEST_F(CrowdBoundsTest, ARestPoseFarFromAllClipsIsLeftOut) {
    Character captured = character_;
    ASSERT_FALSE(captured.clips.empty());
    const float height = captured.bounds_max.y - captured.bounds_min.y;
    const auto bounds_where_clips_begin_at = [&](float above_rest) {
        for (Clip& clip : captured.clips) {
            clip.bounds_min.y = captured.bounds_min.y + above_rest;
            clip.bounds_max.y = clip.bounds_min.y + 2 * height;
        }
        return world_bounds(create({.groups = {{.character = &captured, .instance_count = 1}}}));
    };
    const Bounds at_rest = bounds_where_clips_begin_at(0.05f * height), in_clips = bounds_where_clips_begin_at(height);
    EXPECT_NEAR(at_rest.min.y, captured.bounds_min.y, 1e-4f * height);
    EXPECT_NEAR(at_rest.max.y, captured.bounds_max.y, 1e-4f * height);
    EXPECT_NEAR(in_clips.min.y, captured.bounds_min.y + height, 1e-4f * height);
    EXPECT_NEAR(in_clips.max.y, captured.bounds_min.y + 3 * height, 1e-4f * height);
}

TEST_F(CrowdBoundsTest, LeaveOutPosesThatAClipMovesFarAway) {
    Character throwing = character_;
    const auto posed_height_where_clips_reach_down = [&](float sizes) {
        throwing.clips[0].bounds_min.y = throwing.bounds_min.y - sizes * throwing.size;
        const Crowd crowd = create({.groups = {{.character = &throwing, .instance_count = 1}}});
        const Bounds posed = bounds_of(std::array{&crowd.state()}, Outliers::kIncluded).posed;
        return (posed.max.y - posed.min.y) / throwing.size;
    };
    const float usual = posed_height_where_clips_reach_down(1);
    EXPECT_NEAR(posed_height_where_clips_reach_down(2), usual + 1, 1e-3f);
    EXPECT_LT(posed_height_where_clips_reach_down(1000), usual + 4);
}

// The other instances look as they would without the stray, which is not visible.
TEST_F(CrowdBoundsTest, AnOutlierDoesNotChangeThePicture) {
    const auto picture_of = [&](const Affine& last) {
        Crowd crowd = create(
            {.groups = {{.character = &character_, .instance_count = kCrowdBoundsCount}}, .culling = Culling{}});
        std::vector<Affine> places = in_a_row(kCrowdBoundsCount);
        places.back() = last;
        EXPECT_TRUE(crowd.set_placement(crowd.instances(), places));
        const Camera camera = fit_camera(main_bounds(crowd), 64.0f / 48);
        return renderer_.render_frame(crowd, 0, camera).value().picture.rgba;
    };
    EXPECT_EQ(picture_of(placed_at(1e6f)), picture_of(placed_at(0, -1e7f)));
}

}  // namespace
}  // namespace throng::test
