// The baselines are exact at the poses they store, and measurably wrong between them and above all in blends of clips.
#include "bench/baselines/baselines.h"

#include "base/failure.h"
#include "tools/cli/statistics.h"
#include "tests/kernel_runner.h"
#include "tests/subset.h"
#include "tests/test_rig.h"

#include <cstdio>
#include <numbers>
#include <numeric>
#include <set>

namespace throng::bench {
namespace {

const test::InSubset kBaselineInSubsets({test::Subset::kGpuAssisted, test::Subset::kSubgroups}, {"Baseline.*"});

using namespace test;

ReferencePose pose_of(const Character& character, const Playback& playback) {
    Result<ReferencePose> pose = reference_pose(character, playback);
    EXPECT_TRUE(pose) << (pose ? "" : pose.error().text());
    return std::move(*pose);
}

// Largest displacement of a vertex, as a fraction of the size.
double error_of(const Baseline& baseline, const Character& character, const Character& baked,
                const Playback& playback) {
    const std::vector<double> all = displacements(character, playback, baseline.skin_matrices(baked, playback));
    return std::accumulate(all.begin(), all.end(), 0.0, worse_of) / character.size;
}

TEST(Baseline, TheTableHasBoth) {
    std::set<std::string_view> names;
    for (const Baseline& baseline : baselines()) {
        names.insert(baseline.name);
        EXPECT_FALSE(baseline.summary.empty());
        EXPECT_FALSE(baseline.source.empty());
        EXPECT_FALSE(baseline.plain.empty());
        EXPECT_FALSE(baseline.software.empty());
    }
    EXPECT_EQ(names, (std::set<std::string_view>{"baked", "flattened"}));
}

TEST(Baseline, BakedIsExactAtItsFrames) {
    const Character character = make_character({.joint_count = 40, .seed = 3});
    const Character stored = baked().bake(character, {.rate = 20});
    for (uint32_t c = 0; c < stored.clips.size(); ++c) {
        const Clip& clip = stored.clips[c];
        EXPECT_EQ(clip.row_count, 20 * (c + 1) + 1);  // 1, 2, … seconds, and the frame that closes the loop
        EXPECT_EQ(stored.times_s[clip.first_time + clip.row_count - 1], clip.duration_s);
        EXPECT_EQ(clip.size_bytes, clip.row_count * (character.palette.size() * 48 + 4) + 16);
        for (uint32_t frame = 0; frame < clip.row_count; ++frame) {
            const Playback playback{
                .first = {.clip = c, .time_s = stored.times_s[clip.first_time + frame], .loop = false}};
            const auto got = baked().skin_matrices(stored, playback);
            const auto wanted = pose_of(character, playback).model_from_bind;
            for (size_t entry = 0; entry < wanted.size(); ++entry)
                ASSERT_EQ(got[entry].as<float>(), wanted[entry].as<float>())
                    << "clip " << c << ", frame " << frame << ", entry " << entry;
        }
    }
    EXPECT_EQ(baked().skin_matrices(stored, {}).front().as<float>(),
              pose_of(character, {}).model_from_bind.front().as<float>());
}

TEST(Baseline, FlattenedIsExactAtItsKeys) {
    constexpr double kRounding = 1e-6;  // of the size: its keys are floats
    const Character character = make_character({.joint_count = 40, .seed = 3, .scale_spread = 0});
    const Character stored = flattened().bake(character, {});
    double worst = error_of(flattened(), character, stored, {});
    for (uint32_t c = 0; c < stored.clips.size(); ++c)
        for (uint32_t row = 0; row < stored.clips[c].row_count; ++row)
            worst = std::max(
                worst,
                error_of(
                    flattened(), character, stored,
                    {.first = {.clip = c, .time_s = stored.times_s[stored.clips[c].first_time + row], .loop = false}}));
    EXPECT_LE(worst, kRounding);
}

TEST(Baseline, ErrsBetweenStoredPoses) {
    constexpr double kVisible = 1e-3;  // of the size, with these wild clips
    const Character character = make_character({.joint_count = 40, .seed = 3, .scale_spread = 0});
    for (const Baseline& baseline : baselines()) {
        const Character stored = baseline.bake(character, {.rate = 10});
        const Clip& clip = stored.clips[0];
        double worst = 0;
        for (uint32_t row = 0; row + 1 < clip.row_count; ++row) {
            const double time_s = (double{stored.times_s[clip.first_time + row]} +
                                   stored.times_s[clip.first_time + row + 1]) /
                                  2;
            worst = std::max(worst, error_of(baseline, character, stored, {.first = {.clip = 0, .time_s = time_s}}));
        }
        EXPECT_GT(worst, kVisible) << baseline.name;
    }
}

TEST(Baseline, TheKernelFollowsTheDefinition) {
    constexpr double kBound = 1e-5;  // of the size
    for (const uint32_t joint_count : {1u, 63u, 65u, 300u}) {
        const Character character = make_character({.joint_count = joint_count, .seed = joint_count});
        const auto clip_count = static_cast<uint32_t>(character.clips.size());
        Random random(joint_count);
        std::vector<Playback> playbacks{{}};  // the rest pose
        for (const float weight : {0.0f, 1.0f, 0.25f, 0.5f})
            for (int i = 0; i < 10; ++i) {
                const auto play = [&] {
                    return ClipPlayback{.clip = random.chance(0.1) ? kNone : random.below(clip_count),
                                        .time_s = random.between(-5, 5),
                                        .loop = random.chance(0.7)};
                };
                playbacks.push_back({.first = play(), .second = play(), .weight = weight});
            }
        for (const Baseline& baseline : baselines()) {
            const Character stored = baseline.bake(character, {});
            Baseline plain = baseline;
            plain.software = plain.plain;
            for (const Baseline& variant : {baseline, plain}) {
                const BaselineCrowd crowd(test_gpu(), variant, stored, playbacks);
                crowd.update(0);
                double worst = 0;
                for (uint32_t i = 0; i < playbacks.size(); ++i) {
                    const std::vector<Affine> got = crowd.read_skin_matrices(i);
                    const std::vector<AffineT<double>> wanted = baseline.skin_matrices(stored, playbacks[i]);
                    ASSERT_EQ(got.size(), wanted.size());
                    for (size_t entry = 0; entry < got.size(); ++entry)
                        worst = std::max(worst, matrix_error(got[entry], wanted[entry], character.size));
                }
                std::printf("  %s, %u joints: %.1e of the size\n", std::string(baseline.name).c_str(), joint_count,
                            worst);
                EXPECT_LE(worst, kBound) << baseline.name << ", " << joint_count << " joints";
            }
        }
    }
}

TEST(Baseline, UpdatesAdvanceTime) {
    const Character character = make_character({.joint_count = 20});
    for (const Baseline& baseline : baselines()) {
        const Character stored = baseline.bake(character, {});
        const std::vector<Playback> playbacks{{.first = {.clip = 1, .time_s = 1.5, .speed = 2}}};
        const BaselineCrowd crowd(test_gpu(), baseline, stored, playbacks);
        EXPECT_GE(crowd.update(0.5f).ms, 0.0);
        const auto wanted = baseline.skin_matrices(stored, {.first = {.clip = 1, .time_s = 2.5}});
        EXPECT_LE(matrix_error(crowd.read_skin_matrices(0).back(), wanted.back(), character.size), 1e-5)
            << baseline.name;
    }
}

TEST(Baseline, AClipBlendedWithItselfErrsByInterpolationAlone) {
    const Character character = make_character({.joint_count = 40, .seed = 5});
    for (const Baseline& baseline : baselines()) {
        const Character stored = baseline.bake(character, {});
        for (const double time_s : {0.11, 0.77, 1.31}) {
            const ClipPlayback play{.clip = 1, .time_s = time_s};
            const double alone = error_of(baseline, character, stored, {.first = play}),
                         blended = error_of(baseline, character, stored,
                                            {.first = play, .second = play, .weight = 0.3f});
            EXPECT_GT(alone, 1e-6) << baseline.name;
            EXPECT_NEAR(blended, alone, 1e-9) << baseline.name;
        }
    }
}

// A chain of equal joints that stands straight in one clip and bends by `angle_rad` in all in the other.
Character bending_chain(double angle_rad) {
    constexpr uint32_t kJoints = 17;
    constexpr float kStep_m = 0.125f;
    Asset asset{.name = "chain"};
    AssetSkin skin{.name = "skin"};
    AssetClip straight{.name = "straight", .duration_s = 1}, bent{.name = "bent", .duration_s = 1};
    AssetPrimitive primitive{.influence_count = 4};
    for (uint32_t joint = 0; joint < kJoints; ++joint) {
        asset.nodes.push_back({.name = "joint",
                               .parent = joint > 0 ? joint - 1 : kNone,
                               .parent_from_node = {.translation = {0, joint > 0 ? kStep_m : 0, 0}}});
        skin.joints.push_back(joint);
        skin.inverse_binds.push_back(
            to_affine(Trs<float>{.translation = {0, -kStep_m * static_cast<float>(joint), 0}}));
        const auto q = axis_angle(Vec3<double>{1, 0, 0}, joint > 0 ? angle_rad / (kJoints - 1) : 0).as<float>();
        straight.tracks.push_back(
            {joint, TrackTarget::kRotation, Interpolation::kLinear, {0, 1}, {0, 0, 0, 1, 0, 0, 0, 1}});
        bent.tracks.push_back(
            {joint, TrackTarget::kRotation, Interpolation::kLinear, {0, 1}, {q.x, q.y, q.z, q.w, q.x, q.y, q.z, q.w}});
        primitive.positions.push_back({0.1f, kStep_m * static_cast<float>(joint), 0});
        primitive.influence_joints.insert(primitive.influence_joints.end(), {static_cast<uint16_t>(joint), 0, 0, 0});
        primitive.influence_weights.insert(primitive.influence_weights.end(), {1, 0, 0, 0});
    }
    for (uint32_t vertex = 0; vertex + 2 < kJoints; ++vertex)
        primitive.indices.insert(primitive.indices.end(), {vertex, vertex + 1, vertex + 2});
    asset.skins.push_back(skin);
    asset.clips = {straight, bent};
    asset.meshes.push_back({.name = "mesh", .primitives = {primitive}});
    asset.mesh_instances.push_back({.node = 0, .mesh = 0, .skin = 0});
    return compiled(asset);
}

TEST(Baseline, BlendingErrsMoreTheMoreAChainBends) {
    for (const Baseline& baseline : baselines()) {
        double last = 1e-6;  // of the size: rounding
        for (const double degrees : {30.0, 60.0, 120.0, 180.0}) {
            const Character character = bending_chain(degrees * std::numbers::pi / 180);
            const double error = error_of(baseline, character, baseline.bake(character, {}),
                                          {.first = {.clip = 0}, .second = {.clip = 1}, .weight = 0.5f});
            std::printf("  %s: a chain of %.2f m, straight and bent by %.0f degrees, blended half: %.1f mm off\n",
                        std::string(baseline.name).c_str(), double{character.size}, degrees,
                        error * character.size * 1000);
            EXPECT_GT(error, 1.5 * last) << baseline.name << ", " << degrees;
            last = error;
        }
    }
}

// The chain's clips hold still, so no track is animated.
TEST(Baseline, FlattenedStoresConstantTracksOnce) {
    const Character stored = flattened().bake(bending_chain(1), {});
    for (const Clip& clip : stored.clips) EXPECT_EQ(clip.row_stride, 0u) << clip.name;
}

TEST(Baseline, RefusesWhatTheDeviceCannotBind) {
    const Character character = make_character({.joint_count = 20});
    for (const Baseline& baseline : baselines()) {
        try {
            baseline.bake(character, {.limit_bytes = 1000});
            FAIL() << baseline.name << " baked";
        } catch (const Failure& failure) {
            EXPECT_EQ(failure.error.code, ErrorCode::kLimit);
            EXPECT_NE(failure.text.find(" 1000 bytes"), std::string::npos) << failure.text;
            EXPECT_NE(failure.text.find(std::string(baseline.name)), std::string::npos) << failure.text;
        }
    }
    const uint64_t needed_bytes = baked().bake(character, {}).keys.size() * 16;
    EXPECT_NO_THROW(baked().bake(character, {.limit_bytes = needed_bytes}));
    EXPECT_THROW(baked().bake(character, {.limit_bytes = needed_bytes - 1}), Failure);
}

}  // namespace
}  // namespace throng::bench
