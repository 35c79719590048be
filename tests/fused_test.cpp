// The fused update against reference_pose(): every method that has one, packed and exact keys, formats of skin matrices, what is kept.
#include "bind/skin_format.h"
#include "fused/fused.h"
#include "scan/scan_planner.h"
#include "scan/scan_shaders.h"
#include "tests/crowd_cases.h"
#include "tests/kernel_runner.h"

#include <cstdio>

namespace throng {
namespace {

using namespace test;

Character packed_character(const AssetSettings& settings) {
    Result<Character> character = compile_character(make_asset(settings), {.error = 1e-4});
    EXPECT_TRUE(character) << character.error().text();
    return *character;
}

double crowd_error(Crowd& crowd, const Character& character, const std::vector<Playback>& playbacks, bool with_model = true) {
    double worst = 0;
    for (uint32_t i = 0; i < playbacks.size(); ++i) worst = std::max(worst, instance_error(crowd, i, character, playbacks[i], with_model));
    return worst;
}

TEST(Fused, EveryMethodFollowsTheReference) {
    const ScanLimits limits = scan_limits(*test_gpu());
    for (const ScanMethod& method : scan_table()) {
        if (scan_shaders(method.name).fused.empty()) continue;
        size_t cases = 0, refused = 0;
        double worst = 0;
        for (const uint32_t joint_count : {1u, 70u, 300u}) {
            const AssetSettings asset{.joint_count = joint_count, .seed = joint_count, .scale_spread = method.format == ScanFormat::kSimilarity ? 0 : 0.1};
            for (const Character& character : {make_character(asset), packed_character(asset)}) {
                Random random(joint_count);
                const std::vector<Playback> playbacks = random_playbacks(random, character, 19);
                std::vector<uint32_t> lane_choices = method.lane_choices(limits);
                if (character.packed) lane_choices.resize(1);  // which keys are read does not depend on the lanes
                for (const uint32_t lanes : lane_choices) {
                    const ScanChoice choice{&method, lanes};
                    const CrowdSettings settings{.groups = {{&character, 19}}, .path = UpdatePath::kFused, .scan = name_of(choice), .keep_model_matrices = true};
                    const FusedPlan plan = plan_fused(choice, FusedRig(character), limits);
                    if (!plan.obstacle.empty()) {
                        const Result<Crowd> crowd = Crowd::create(test_device(), settings);
                        ASSERT_FALSE(crowd);
                        EXPECT_EQ(crowd.error().code, ErrorCode::kUnsupported);
                        EXPECT_NE(crowd.error().text().find(plan.obstacle), std::string::npos) << crowd.error().text();
                        ++refused;
                        continue;
                    }
                    Crowd crowd = create(settings);
                    ASSERT_TRUE(crowd.is_fused(0));
                    ASSERT_TRUE(crowd.set_playback(0, playbacks));
                    ASSERT_TRUE(crowd.update(0));
                    const double error = crowd_error(crowd, character, playbacks);
                    EXPECT_LE(error, 2 * kPoseBound) << settings.scan << ", " << joint_count << " joints, " << (character.packed ? "packed" : "exact");
                    worst = std::max(worst, error);
                    ++cases;
                }
            }
        }
        EXPECT_GT(cases, 0u) << method.name;
        std::printf("  %-22s %3zu cases, %zu refused: largest error %.1e of the size\n", std::string(method.name).c_str(), cases, refused, worst);
    }
}

// Few instances share a subgroup's lanes, many have one each, and more than a workgroup's leave the last one partly empty.
TEST(Fused, AnyNumberOfInstances) {
    const Character character = packed_character({.joint_count = 70, .seed = 3});
    for (const uint32_t count : {1u, 2u, 3u, 7u, 8u, 9u, 15u, 16u, 17u, 100u}) {
        Crowd crowd = create({.groups = {{&character, count}}, .path = UpdatePath::kFused, .keep_model_matrices = true});
        Random random(count);
        const std::vector<Playback> playbacks = random_playbacks(random, character, count);
        ASSERT_TRUE(crowd.set_playback(0, playbacks));
        ASSERT_TRUE(crowd.update(0));
        EXPECT_LE(crowd_error(crowd, character, playbacks), kPoseBound) << count << " instances by " << crowd.scan(0).method;
    }
}

// The kernel for one clip an instance takes over when none blends, and hands back when one does.
TEST(Fused, OneClipAndTwoTakeTurns) {
    const Character character = packed_character({.joint_count = 40, .seed = 8});
    Crowd crowd = create({.groups = {{&character, 20}}, .path = UpdatePath::kFused, .keep_model_matrices = true});
    Random random(4);
    std::vector<Playback> playbacks = random_playbacks(random, character, 20);
    const auto blending_count = [&] { return crowd.state().batches[0].blending_count; };
    const auto show = [&](auto weight_of, uint32_t wanted_count) {
        for (uint32_t i = 0; i < playbacks.size(); ++i) playbacks[i].weight = weight_of(i);
        ASSERT_TRUE(crowd.set_playback(0, playbacks));
        EXPECT_EQ(blending_count(), wanted_count);
        ASSERT_TRUE(crowd.update(0));
        EXPECT_LE(crowd_error(crowd, character, playbacks), kPoseBound);
    };
    show([](uint32_t i) { return i % 2 == 0 ? 0.0f : 1.0f; }, 0);
    show([](uint32_t i) { return i == 13 ? 0.25f : 1.0f; }, 1);
    show([](uint32_t) { return 0.5f; }, 20);
    show([](uint32_t) { return 0.0f; }, 0);
}

TEST(Fused, EveryFormatOnBothPathsStaysWithinItsError) {
    const Character character = make_character({.joint_count = 120, .seed = 12, .scale_spread = 0});
    Random random(7);
    const std::vector<Playback> playbacks = random_playbacks(random, character, 11);
    struct Case {
        SkinFormat format;
        double bound;  // of the size
        uint32_t bytes;
    };
    for (const UpdatePath path : {UpdatePath::kFused, UpdatePath::kStaged}) {
        for (const Case& c : {Case{SkinFormat::kAffine, kPoseBound, 48}, Case{SkinFormat::kHalfAffine, 5e-3, 24}, Case{SkinFormat::kSimilarity, 2e-5, 32}}) {
            EXPECT_EQ(skin_format_bytes(c.format), c.bytes);
            Crowd crowd = create({.groups = {{&character, 11}}, .path = path, .skin_format = c.format});
            ASSERT_TRUE(crowd.set_playback(0, playbacks));
            ASSERT_TRUE(crowd.update(0));
            const double error = crowd_error(crowd, character, playbacks, false);
            EXPECT_LE(error, c.bound) << "path " << static_cast<int>(path) << ", " << c.bytes << " bytes";
            if (c.format == SkinFormat::kHalfAffine) { EXPECT_GT(error, 1e-5) << "halves were not used"; }
            std::printf("  %s, %u bytes: largest error %.1e of the size\n", path == UpdatePath::kFused ? "fused" : "staged", c.bytes, error);
        }
    }
}

TEST(Fused, SimilaritiesAreRefusedWhereTheyCannotHoldTheMatrices) {
    const Character scaled = make_character({.joint_count = 20, .scale_spread = 0.1});
    Character sheared = make_character({.joint_count = 20, .scale_spread = 0});
    sheared.palette[3].joint_from_bind.row[0][1] += 0.5f;
    for (const Character& character : {scaled, sheared}) {
        const Result<Crowd> crowd = Crowd::create(test_device(), {.groups = {{&character, 2}}, .skin_format = SkinFormat::kSimilarity});
        ASSERT_FALSE(crowd);
        EXPECT_EQ(crowd.error().code, ErrorCode::kUnsupported);
        EXPECT_NE(crowd.error().text().find("32-byte skin matrices"), std::string::npos) << crowd.error().text();
    }
    EXPECT_NE(skin_format_obstacle(SkinFormat::kSimilarity, sheared).find("entry 3"), std::string::npos);
}

// Mirrors and turns about every axis, so that each component is the largest once.
TEST(Fused, SimilaritiesOfMirrorsAndHalfTurns) {
    Character character = make_character({.joint_count = 9, .scale_spread = 0});
    for (size_t entry = 0; entry < character.palette.size(); ++entry) {
        const std::array<Quaternion<float>, 5> turns{{{0, 0, 0, 1}, {1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0.6f, 0, 0.8f, 0}}};
        const float scale = entry % 2 == 0 ? 1.5f : -0.5f;
        character.palette[entry].joint_from_bind = to_affine(Trs<float>{.rotation = turns[entry % turns.size()], .translation = {1, 2, 3}, .scale = {scale, scale, scale}});
    }
    Random random(21);
    const std::vector<Playback> playbacks = random_playbacks(random, character, 9);
    Crowd crowd = create({.groups = {{&character, 9}}, .path = UpdatePath::kFused, .skin_format = SkinFormat::kSimilarity});
    ASSERT_TRUE(crowd.set_playback(0, playbacks));
    ASSERT_TRUE(crowd.update(0));
    EXPECT_LE(crowd_error(crowd, character, playbacks, false), 2e-5);
}

TEST(Fused, PreviousMatricesAreThoseOfTheUpdateBefore) {
    const Character character = small_character();
    for (const UpdatePath path : {UpdatePath::kFused, UpdatePath::kStaged}) {
        Crowd crowd = create({.groups = {{&character, 6}}, .path = path, .keep_previous_matrices = true});
        Random random(2);
        ASSERT_TRUE(crowd.set_playback(0, random_playbacks(random, character, 6)));
        const auto read = [&](VkBuffer buffer) { return download<Affine>(test_gpu(), BufferRange(buffer, 0, 6 * character.palette.size() * sizeof(Affine))); };
        std::vector<Affine> last;
        for (int update = 0; update < 4; ++update) {
            ASSERT_TRUE(crowd.update(0.13f));
            const OutputBlock& block = crowd.outputs()[0];
            const std::vector<Affine> now = read(block.skin_buffer), previous = read(block.previous_skin_buffer);
            EXPECT_TRUE(same_bits(now, skins_of(crowd)));
            if (update == 0) { EXPECT_TRUE(same_bits(previous, now)) << "nothing has moved yet"; }
            else {
                EXPECT_TRUE(same_bits(previous, last));
                EXPECT_FALSE(same_bits(previous, now));
            }
            last = now;
        }
    }
    EXPECT_FALSE(create({.groups = {{&character, 1}}}).outputs()[0].previous_skin_buffer);
}

TEST(Fused, WhatDoesNotFitIsStagedUnlessAskedFor) {
    const Character large = make_character({.name = "large", .joint_count = 65535, .shape = RigShape::kBushy, .scale_spread = 0, .clip_count = 1, .axis_count = 1, .key_count = 2});
    const ScanLimits limits = scan_limits(*test_gpu());
    const FusedPlan plan = choose_fused(FusedRig(large), limits);
    ASSERT_FALSE(plan.obstacle.empty());
    const Crowd crowd = create({.groups = {{&large, 2}}});
    EXPECT_FALSE(crowd.is_fused(0));
    EXPECT_NE(crowd.path_reason(0).find(plan.obstacle), std::string::npos) << crowd.path_reason(0);
    const Result<Crowd> refused = Crowd::create(test_device(), {.groups = {{&large, 2}}, .path = UpdatePath::kFused});
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::kUnsupported);
    const Character character = small_character();
    EXPECT_FALSE(create({.groups = {{&character, 2}}, .scan = "gateau2012_walk"}).is_fused(0)) << "it has no fused form";
    EXPECT_TRUE(create({.groups = {{&character, 2}}}).is_fused(0));
}

}  // namespace
}  // namespace throng
