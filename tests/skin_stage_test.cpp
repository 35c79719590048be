// Crowds whose vertices are skinned once by a compute stage: the vertices match the reference, and pictures match those
// of crowds that are skinned in the draw.
#include "skin/skin_reference.h"
#include "tests/crowd_cases.h"
#include "tests/kernel_runner.h"
#include "tests/subset.h"
#include "tools/creatures/creature.h"

#include <throng/draw.h>

#include <gtest/gtest.h>

#include <cstdio>
#include <set>

namespace throng::test {
namespace {

const InSubset kSkinStageInSubsets({Subset::kGpuAssisted}, {"SkinStage.OnlyListedInstancesAreSkinnedWithAView",
                                                            "SkinStage.DualQuaternionsFollowTheReference"});
const InSubset kSkinStageOnOtherDrivers({Subset::kOtherDriver}, {"-SkinStage.*"});
const InSubset kSkinStageNatively({Subset::kNative}, {"SkinStage.*"});

constexpr uint32_t kSkinStageWidth = 160, kSkinStageHeight = 120;

std::vector<SkinnedVertex> skinned_of(Crowd& crowd, uint32_t instance) {
    for (const OutputBlock& block : crowd.outputs()) {
        if (instance < block.first_instance || instance >= block.first_instance + block.instance_count) continue;
        const uint64_t size_bytes = uint64_t{block.vertex_count} * sizeof(SkinnedVertex);
        return download<SkinnedVertex>(
            test_gpu(),
            output_range(block, &OutputBlock::skinned, (instance - block.first_instance) * size_bytes, size_bytes));
    }
    return {};
}

std::vector<Vec3<double>> wanted_positions(const Character& character, const Playback& playback, SkinBlend blend) {
    const ReferencePose pose = *reference_pose(character, playback);
    return skin_reference(character, pose.model_from_bind, {}, blend);
}

TEST(SkinStage, AllInstancesAreSkinnedWithoutAView) {
    const Character first = small_character(), second = creature(40, 12);
    for (const UpdatePath path : {UpdatePath::kFused, UpdatePath::kStaged}) {
        Random random(3);
        Crowd crowd = create({.groups = {{&first, 30}, {&second, 20}},
                              .path = path,
                              .keep_previous_matrices = true,
                              .skins_once = true});
        std::vector<Playback> playbacks = random_playbacks(random, first, 30);
        for (const Playback& playback : random_playbacks(random, second, 20)) playbacks.push_back(playback);
        ASSERT_TRUE(crowd.set_playback(crowd.instances(), playbacks));
        double worst = 0;
        for (int step = 0; step < 2; ++step) {  // one for each skin buffer
            ASSERT_TRUE(crowd.update(0.1f));
            for (uint32_t i = 0; i < 50; ++i) {
                const Character& character = i < 30 ? first : second;
                playbacks[i] = advanced(playbacks[i], character, double{0.1f});
                const std::vector<SkinnedVertex> got = skinned_of(crowd, i);
                const std::vector<Vec3<double>> wanted = wanted_positions(character, playbacks[i], SkinBlend::kLinear);
                ASSERT_EQ(got.size(), wanted.size());
                for (const MeshSection& section : character.sections)
                    for (size_t v = section.first_vertex; v < section.first_vertex + section.own_vertex_count(); ++v)
                        worst = worse_of(worst,
                                         length(got[v].position.as<double>() - wanted[v]) / double{character.size});
            }
        }
        EXPECT_LE(worst, 2 * kPoseBound);
        EXPECT_GT(crowd.stage_times()->of("skin"), 0);
    }
}

// Listed instances have the vertices of their level; others are left unchanged.
TEST(SkinStage, OnlyListedInstancesAreSkinnedWithAView) {
    const Character character = *compile_character(
        *make_creature({.joint_count = 40, .level_count = 12, .face_count = 800}));
    ASSERT_GE(character.lods.size(), 2u);
    constexpr uint32_t kCount = 200;
    Random random(5);
    Crowd crowd = create(
        {.groups = {{&character, kCount}}, .culling = Culling{.reduces_joints = true}, .skins_once = true});
    std::vector<Affine> places;
    for (uint32_t i = 0; i < kCount; ++i)
        places.push_back(to_affine(Trs<double>{.translation = {random.between(-30, 30) * character.size, 0,
                                                               random.between(-60, 5) * character.size}})
                             .as<float>());
    ASSERT_TRUE(crowd.set_placement(crowd.instances(), places));
    ASSERT_TRUE(crowd.set_playback(crowd.instances(), random_playbacks(random, character, kCount)));
    CrowdView view = *view_of({.eye = {0, character.size, 0}, .target = {0, 0, -10 * character.size}}, kSkinStageWidth,
                              kSkinStageHeight, {});
    view.lod_pixels = 0.5f;
    ASSERT_TRUE(crowd.update(0.1f, &view));
    std::vector<std::vector<SkinnedVertex>> before;
    for (uint32_t i = 0; i < kCount; ++i) before.push_back(skinned_of(crowd, i));
    ASSERT_TRUE(crowd.update(0.1f, &view));
    std::set<uint32_t> lods;
    std::vector<uint32_t> lod_of(kCount, kNone);
    for (const DrawnInstance& drawn : drawn_of(crowd)) {
        lod_of[drawn.instance] = drawn.lod;
        lods.insert(drawn.lod);
    }
    EXPECT_GE(lods.size(), 3u);
    uint32_t left_alone = 0;
    double worst = 0;
    for (uint32_t i = 0; i < kCount; ++i) {
        const std::vector<SkinnedVertex> got = skinned_of(crowd, i);
        if (lod_of[i] == kNone) {
            EXPECT_TRUE(same_bits(got, before[i])) << "instance " << i;
            ++left_alone;
            continue;
        }
        std::vector<uint32_t> indices = character.indices;
        if (const uint32_t lod = lod_of[i]; lod > 0) {
            ASSERT_EQ(character.sections.size(), 1u);
            const IndexRange& range = character.lod_ranges[lod - 1];
            indices.assign(character.lod_indices.begin() + range.first_index,
                           character.lod_indices.begin() + range.first_index + range.index_count);
        }
        Character reduced = character;
        reduced.influences = influences_of_lod(character, lod_of[i]);
        const std::vector<Affine> read = *crowd.read_skin_matrices({i});
        std::vector<AffineT<double>> matrices;
        for (const Affine& matrix : read) matrices.push_back(matrix.as<double>());
        const std::vector<Vec3<double>> wanted = skin_reference(lod_of[i] > 0 ? reduced : character, matrices);
        for (const uint32_t v : indices)
            worst = worse_of(worst, length(got[v].position.as<double>() - wanted[v]) / double{character.size});
    }
    EXPECT_GT(left_alone, 20u);
    EXPECT_LE(worst, 1e-6);
}

// Normals are rounded to 16 bits, so colours may differ slightly.
void expect_like(const Picture& picture, const Picture& other) {
    ASSERT_EQ(picture.rgba.size(), other.rgba.size());
    int most = 0;
    uint32_t differ = 0;
    for (size_t i = 0; i < picture.rgba.size(); ++i) {
        const int difference = std::abs(int{picture.rgba[i]} - int{other.rgba[i]});
        most = std::max(most, difference);
        differ += difference > 2;
    }
    EXPECT_LE(differ, picture.rgba.size() / 1000) << "largest difference " << most;
}

TEST(SkinStage, PicturesEqualSkinningWhileDrawing) {
    const Character character = creature(40, 12);
    Random random(6);
    std::vector<Affine> places;
    for (uint32_t i = 0; i < 12; ++i)
        places.push_back(to_affine(Trs<double>{axis_angle(Vec3<double>{0, 1, 0}, random.between(0, 6)),
                                               random.vector(2 * character.size),
                                               {i % 3 ? 1.0 : -1.5, 1, 1}})
                             .as<float>());
    const std::vector<Playback> playbacks = random_playbacks(random, character, 12);
    Result<Renderer> renderer = Renderer::create(test_device(), {.width = kSkinStageWidth, .height = kSkinStageHeight});
    ASSERT_TRUE(renderer);
    for (const SkinBlend blend : {SkinBlend::kLinear, SkinBlend::kDualQuaternion}) {
        std::vector<Picture> pictures;
        for (const bool culls : {false, true})
            for (const bool once : {false, true}) {
                Crowd crowd = create({.groups = {{&character, 12}},
                                      .culling = culls ? std::optional(Culling{}) : std::nullopt,
                                      .skin_blend = blend,
                                      .skins_once = once});
                ASSERT_TRUE(crowd.set_placement(crowd.instances(), places) &&
                            crowd.set_playback(crowd.instances(), playbacks));
                const Camera camera = fit_camera(world_bounds(crowd), 4.0f / 3);
                Result<RenderResult> result = renderer->render_frame(crowd, 0.1f, camera);
                ASSERT_TRUE(result) << result.error().text();
                // A second frame, in which the second half of the update lists some
                if (culls) result = renderer->render_frame(crowd, 0, camera);
                ASSERT_TRUE(result);
                pictures.push_back(result->picture);
            }
        expect_like(pictures[0], pictures[1]);
        expect_like(pictures[2], pictures[3]);  // coarser levels are drawn
    }
}

TEST(SkinStage, DualQuaternionsFollowTheReference) {
    const Character character = make_character({.joint_count = 20, .scale_spread = 0});
    for (const SkinFormat format : {SkinFormat::kAffine, SkinFormat::kSimilarity}) {
        Random random(8);
        Crowd crowd = create(
            {.groups = {{&character, 20}}, .skin_format = format, .skin_blend = SkinBlend::kDualQuaternion});
        const std::vector<Playback> playbacks = random_playbacks(random, character, 20);
        ASSERT_TRUE(crowd.set_playback(crowd.instances(), playbacks) && crowd.update(0));
        double worst = 0, moved = 0;
        for (uint32_t i = 0; i < 20; ++i) {
            const std::vector<Vec3<float>> got = *crowd.read_positions({i});
            const Playback playback = advanced(playbacks[i], character, 0);
            const std::vector<Vec3<double>> wanted = wanted_positions(character, playback, SkinBlend::kDualQuaternion),
                                            linear = wanted_positions(character, playback, SkinBlend::kLinear);
            for (size_t v = 0; v < got.size(); ++v) {
                worst = worse_of(worst, length(got[v].as<double>() - wanted[v]) / double{character.size});
                moved = std::max(moved, length(linear[v] - wanted[v]) / double{character.size});
            }
        }
        EXPECT_LE(worst, 2 * kPoseBound);
        EXPECT_GT(moved, 1e-3) << "they are another blend";
    }
}

TEST(SkinStage, WhatDualQuaternionsCannotBlendIsRefused) {
    const Character character = make_character({.joint_count = 20, .scale_spread = 0.1});
    const Result<Crowd> crowd = Crowd::create(test_device(),
                                              {.groups = {{&character, 2}}, .skin_blend = SkinBlend::kDualQuaternion});
    ASSERT_FALSE(crowd);
    EXPECT_EQ(crowd.error().code, ErrorCode::kUnsupported);
    EXPECT_NE(crowd.error().text().find("use the linear blend"), std::string::npos) << crowd.error().text();
}

}  // namespace
}  // namespace throng::test
