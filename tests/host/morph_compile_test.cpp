// Compilation of morph targets.
#include "morph/morph_reference.h"
#include "tests/morph_cases.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace throng {
namespace {

using namespace test;

constexpr double kCubicBound = 1e-4;

TEST(MorphCompile, CompilesWhatTargetsMove) {
    Asset asset = small_asset();
    asset.meshes.push_back(asset.meshes[0]);
    asset.meshes[2].target_names = {"a", "b", "c"};
    asset.mesh_instances.push_back({.node = 2, .mesh = 2, .skin = kNone, .weights = {1, 2, 3}});
    const Character character = compiled(asset), without = compiled([&] {
                                                     Asset plain = asset;
                                                     for (AssetMesh& mesh : plain.meshes) {
                                                         mesh.weights.clear();
                                                         mesh.target_names.clear();
                                                         mesh.primitives[0].targets.clear();
                                                     }
                                                     plain.mesh_instances[2].weights.clear();
                                                     return plain;
                                                 }());
    ASSERT_EQ(character.morphs.size(), 6u);
    EXPECT_EQ(character.morphs[1].name, "mesh.1");
    EXPECT_EQ(character.morphs[1].default_weight, 0.5f);
    EXPECT_EQ(character.morphs[5].name, "c");
    EXPECT_EQ(character.find_morph("mesh.1"), 1u);
    EXPECT_EQ(character.find_morph("c"), 5u);
    EXPECT_EQ(character.find_morph("no such morph"), kNone);
    EXPECT_EQ(character.morphs[5].node, 2u);
    EXPECT_EQ(character.morphs[5].target, 2u);
    EXPECT_EQ(character.morphs[5].default_weight, 3);
    ASSERT_EQ(character.sections.size(), 3u);
    EXPECT_EQ(character.sections[0].morph_count, 3u);
    EXPECT_EQ(character.sections[1].morph_count, 0u);
    EXPECT_EQ(character.sections[2].first_morph, 3u);
    EXPECT_EQ(character.morph_deltas.size(), 12u) << "two vertices of two sections, by three targets";
    const Vertex& first = character.vertices[0];
    ASSERT_EQ(first.first_delta, 1u);
    EXPECT_EQ(character.morph_deltas[0].position, (Vec3<float>{1, 2, 3}));
    EXPECT_EQ(character.morph_deltas[1].position, (Vec3<float>{}));
    EXPECT_EQ(character.vertices[1].first_delta, 0u);
    ASSERT_EQ(character.vertices[3].first_delta, 4u);
    EXPECT_EQ(character.morph_deltas[4].normal, (static_cast<uint32_t>(-511) & 1023) << 10 | 128u << 20);
    // Bounds are of the character at rest, with the default weights applied.
    Vec3<double> low{1e9, 1e9, 1e9};
    for (const Vec3<double>& p : reference_positions(character, *reference_pose(character, {})))
        low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    EXPECT_NEAR(length(character.bounds_min.as<double>() - low), 0, 1e-5);
    EXPECT_GT(character.size, without.size);
    EXPECT_TRUE(character.morph_values.empty() && character.morph_times_s.empty());
    EXPECT_EQ(character.morph_tracks, std::vector<uint32_t>(12, kNone));
}

TEST(MorphCompile, ConstantsAreOneValueAndStepsStayExact) {
    const Character character = compiled(small_asset({{.node = 0,
                                                       .interpolation = Interpolation::kStep,
                                                       .times_s = {0.25f, 0.5f, 0.75f},
                                                       .values = {1, 0, 7, 2, 0, 7, 3, 0, 7}}}));
    const Clip& clip = character.clips[0];
    EXPECT_EQ(clip.morph_row_count, 3u);
    EXPECT_EQ(clip.morph_row_stride, 1u);
    EXPECT_EQ(character.morph_values.size(), 3u + 2u);
    EXPECT_EQ(character.clips[1].morph_row_count, 0u);
    const auto weight = [&](uint32_t morph, double time_s) {
        return *morph_weight_reference(character, 0, morph, time_s);
    };
    for (const auto& [time_s, wanted] : std::initializer_list<std::pair<double, double>>{
             {0, 1}, {0.25, 1}, {0.499999, 1}, {0.5, 2}, {0.74, 2}, {0.75, 3}, {9, 3}})
        EXPECT_EQ(weight(0, time_s), wanted) << time_s;
    EXPECT_EQ(weight(1, 0.6), 0);
    EXPECT_EQ(weight(2, 0.6), 7);
    EXPECT_FALSE(morph_weight_reference(character, 1, 0, 0.6)) << "another clip";
}

TEST(MorphCompile, RowsFollowTheTracksOfTheFile) {
    double worst = 0, worst_cubic = 0;
    size_t rows = 0;
    for (uint64_t seed = 1; seed <= 12; ++seed) {
        const Asset asset = make_asset({.joint_count = 5, .seed = seed, .cubic = true, .morph_count = 5});
        for (const double error : {0.0, 1e-4}) {
            const Character character = compiled(asset, {.error = error});
            ASSERT_EQ(character.morphs.size(), 10u);
            rows += character.morph_times_s.size();
            for (uint32_t clip = 0; clip < asset.clips.size(); ++clip)
                for (uint32_t morph = 0; morph < 10; ++morph) {
                    const AssetMorphTrack* track = track_of(asset.clips[clip], morph / 5);
                    EXPECT_EQ(morph_weight_reference(character, clip, morph, 0).has_value(), track != nullptr);
                    for (int i = 0; track && i <= 500; ++i) {
                        const double time_s = asset.clips[clip].duration_s * i / 500;
                        const double difference = std::abs(*morph_weight_reference(character, clip, morph, time_s) -
                                                           weight_of_track(*track, 5, morph % 5, time_s));
                        double& largest = track->interpolation == Interpolation::kCubicSpline ? worst_cubic : worst;
                        largest = worse_of(largest, difference);
                    }
                }
        }
    }
    EXPECT_LE(worst, 1e-6);
    EXPECT_LE(worst_cubic, kCubicBound);
    std::printf("  %zu rows of weights: largest error %.1e, of cubic tracks %.1e\n", rows, worst, worst_cubic);
}

TEST(MorphCompile, LimitsAreNamed) {
    const auto refused = [](const Asset& asset, const char* what) {
        const Result<Character> result = compile_character(asset, kExact);
        ASSERT_FALSE(result);
        EXPECT_EQ(result.error().code, ErrorCode::kLimit);
        EXPECT_NE(result.error().text().find(what), std::string::npos) << result.error().text();
    };
    Asset many = small_asset();
    many.meshes[0].weights.resize(4097);
    many.meshes[0].primitives[0].targets.resize(4097);
    refused(many, "the limit is 4096");
    Asset wild = small_asset({{.node = 0,
                               .interpolation = Interpolation::kCubicSpline,
                               .times_s = {0, 1000},
                               .values = std::vector<float>(18, 1e6f)}});
    wild.clips[0].duration_s = 1000;
    for (size_t i = 0; i < 18; i += 2) wild.clips[0].morph_tracks[0].values[i] = i % 4 == 0 ? 1e9f : -1e9f;
    for (const size_t i : {3u, 4u, 5u, 12u, 13u, 14u}) wild.clips[0].morph_tracks[0].values[i] = 0;
    refused(wild, "weights to be followed");
}

}  // namespace
}  // namespace throng
