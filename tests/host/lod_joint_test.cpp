// Which joints move in a level of detail.
#include "compile/rig/joint_lod.h"
#include "reference/reference.h"
#include "skin/skin_reference.h"
#include "tests/host/lod_cases.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace throng::test {
namespace {

TEST(Lod, WithoutClipsNoJointIsLeftOut) {
    Asset asset = make_strip();
    asset.clips.clear();
    const Character character = *compile_character(asset);
    ASSERT_FALSE(character.lods.empty());
    EXPECT_TRUE(character.joint_lods.empty());
    EXPECT_GT(character.lods[0].error, 0) << "or it would be drawn where there is no view";
}

// A chain of joints at rest, whose last joint has a vertex. Only `mover` moves, by `by`.
Character chain_with_one_that_moves(uint32_t joint_count, uint32_t mover, float by) {
    Character character{.clips = {{.duration_s = 1, .row_count = 1}},
                        .times_s = {0},
                        .keys = {{0, 0, 0, 1}, {0, 0, 0, 0}, {1, 1, 1, 0}, {by, 0, 0, 0}},
                        .skins = {{.joint_count = joint_count}}};
    for (uint32_t joint = 0; joint < joint_count; ++joint) {
        character.rig.parents.push_back(joint - 1);  // of the root: kNone
        character.rig.rest.emplace_back();
        character.palette.push_back({.joint = joint});
    }
    character.tracks.assign(2 * size_t{joint_count}, {.rotation = 0, .translation = 1, .scale = 2});
    character.tracks[mover].translation = 3;
    character.vertices.resize(1);
    character.influences = {{.weights = {1, 0, 0, 0}, .entries = {static_cast<uint16_t>(joint_count - 1)}}};
    character.sections = {{.vertex_count = 1}};
    character.lods = {{1}, {10}};
    return character;
}

TEST(Lod, JointsOfDeepChainsAreWeighedInOneWalk) {
    constexpr uint32_t kJoints = kSanitized ? 5'000 : 20'000;
    Character far = chain_with_one_that_moves(kJoints, kJoints - 1, 4),
              near = chain_with_one_that_moves(kJoints, kJoints - 1, 0.25f),
              middle = chain_with_one_that_moves(kJoints, kJoints / 2, 4);
    make_joint_lods(far);
    EXPECT_EQ(std::ranges::count(far.joint_lods, 1u), kJoints - 1) << "in the second level none but the root moves";
    EXPECT_EQ(far.joint_lods[0], 2u);
    EXPECT_EQ(far.lods[0].error, 1);
    EXPECT_EQ(far.lods[1].error, 14) << "that of the surface, and of the joint that does not move";
    make_joint_lods(near);
    EXPECT_EQ(std::ranges::count(near.joint_lods, 0u), kJoints - 1);
    EXPECT_EQ(near.lods[0].error, 1.25f);
    make_joint_lods(middle);
    EXPECT_EQ(std::ranges::count(middle.joint_lods, 1u), kJoints / 2) << "those below it rest";
}

// Like a jaw that moves in only one of many clips, and is still in the middle of that clip.
TEST(Lod, JointsThatMoveOnlyEarlyAndLateInOneClipMove) {
    constexpr uint32_t kJoints = 3, kClips = 40, kMoving = 7;
    Character character = chain_with_one_that_moves(kJoints, kJoints - 1, 0);
    const JointTracks still = character.tracks[0];
    character.tracks.assign((kClips + 1) * kJoints, still);
    character.tracks[kMoving * kJoints + kJoints - 1].translation = kTrackAnimated | 3;
    character.keys.resize(3);
    for (const float by : {0.0f, 4.0f, 0.0f, 0.0f, 4.0f, 0.0f}) character.keys.push_back({by, 0, 0, 0});
    character.times_s = {0, 0.15f, 0.3f, 0.7f, 0.85f, 1};
    character.clips.assign(kClips, character.clips[0]);
    character.clips[kMoving].row_count = 6;
    character.clips[kMoving].row_stride = 1;
    make_joint_lods(character);
    EXPECT_EQ(character.joint_lods, (std::vector<uint32_t>{2, 1, 1})) << "all, or the last joint would stop at once";
}

// With only a level's joints, a skinned vertex stays within a third of the level's error of its position with all
// joints, in the rest pose and at random times of clips.
TEST(Lod, JointsOfALevelAreEnoughForIt) {
    const Character character = with_lods();
    const uint32_t joint_count = character.rig.joint_count();
    ASSERT_EQ(character.joint_lods.size(), joint_count);
    Random random(5);
    uint32_t count_before = joint_count;
    for (uint32_t lod = 1; lod <= character.lods.size(); ++lod) {
        Character reduced = character;
        reduced.influences = influences_of_lod(character, lod);
        uint32_t count = 0;
        for (uint32_t joint = 0; joint < joint_count; ++joint) {
            const uint32_t parent = character.rig.parents[joint];
            ASSERT_LE(character.joint_lods[joint],
                      parent == kNone ? character.lods.size() : character.joint_lods[parent]);
            count += character.joint_lods[joint] >= lod;
        }
        for (const Influences& influences : reduced.influences)
            for (const uint16_t entry : influences.entries)
                ASSERT_GE(character.joint_lods[character.palette[entry].joint], lod);
        double furthest = 0;
        for (const ReferencePose& pose : rest_and_random_poses(character, 29, random)) {
            const std::vector<Vec3<double>> all = skin_reference(character, pose.model_from_bind),
                                            some = skin_reference(reduced, pose.model_from_bind);
            for (size_t vertex = 0; vertex < all.size(); ++vertex)
                furthest = worse_of(furthest, length(all[vertex] - some[vertex]));
        }
        EXPECT_LE(furthest, 1.1 / 3 * character.lods[lod - 1].error);
        EXPECT_LE(count, count_before);
        std::printf("  level %u: %u of %u joints, a vertex moves by %.1e of the size; the mesh by %.1e\n", lod, count,
                    joint_count, furthest / character.size, character.lods[lod - 1].error / character.size);
        count_before = count;
    }
    EXPECT_LT(count_before, joint_count / 2);
    EXPECT_EQ(influences_of_lod(character, 0).size(), character.influences.size());
}

}  // namespace
}  // namespace throng::test
