// Drawing a square, whose colour shows what was drawn.
#include "base/failure.h"
#include "crowd/crowd_state.h"
#include "draw/textures.h"
#include "tests/ball.h"
#include "tests/draw_cases.h"
#include "tests/png.h"
#include "tests/subset.h"
#include "tests/test_device.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace throng {
namespace {

using namespace test;

// Under GPU-assisted validation the excluded tests take too long.
const InSubset kDrawInSubsets({Subset::kGpuAssisted},
                              {"Draw.*", "-Draw.AlphaMasksDiscardPixelsBelowTheCutoff",
                               "-Draw.BlendedMaterialsAreTransparent", "-Draw.MirroredInstancesKeepTheirFrontFaces",
                               "-Draw.DrawsBrokenImagesWhite"}),
    kDrawNatively({Subset::kNative}, {"Draw.*", "-Draw.AFailedUploadIsNotBlamedOnTheNextTexture"});

// Draws a crowd of `asset`, an instance for each placement, seen along -z: one unit is 14 pixels, x = 0 is in the
// middle.
Picture draw(const Asset& asset, const std::vector<Affine>& placements = {Affine{}}, uint32_t samples = 1,
             double clip_time_s = 0) {
    const Result<Character> character = compile_character(asset, kExact);
    EXPECT_TRUE(character) << (character ? "" : character.error().text());
    Result<Crowd> crowd = Crowd::create(test_device(),
                                        {.groups = {{&*character, static_cast<uint32_t>(placements.size())}}});
    EXPECT_TRUE(crowd);
    EXPECT_TRUE(crowd->set_placement(crowd->instances(), placements));
    const std::vector<Playback> playback(placements.size(),
                                         {.first = {.clip = 0, .time_s = clip_time_s, .loop = false}});
    EXPECT_TRUE(crowd->set_playback(crowd->instances(), playback));
    EXPECT_TRUE(crowd->update(0));
    const Result<RenderResult> result = shared_renderer(samples).render(*crowd, kFront);
    EXPECT_TRUE(result) << (result ? "" : result.error().text());
    EXPECT_GE(result->draw_ms, 0);
    EXPECT_EQ(result->picture.rgba.size(), kDrawWidth * kDrawHeight * 4);
    return result->picture;
}

TEST(Draw, ShowsFrontFacesUprightAndNothingElse) {
    for (const uint32_t samples : {1u, 4u}) {
        const Picture picture = draw(square(), {Affine{}}, samples);
        EXPECT_TRUE(is_red(at(picture, 0, 0.5)));
        EXPECT_TRUE(is_red(at(picture, -0.4, 0.1)));
        EXPECT_TRUE(is_red(at(picture, 0.4, 0.9)));
        EXPECT_TRUE(is_pale(at(picture, 0, 1.3))) << "above";
        EXPECT_TRUE(is_pale(at(picture, 0, -0.3))) << "below";
        EXPECT_TRUE(is_pale(at(picture, -0.7, 0.5)));
        EXPECT_TRUE(is_pale(at(picture, 0.7, 0.5)));
    }
}

TEST(Draw, CullsBackFacesOfOneSidedMaterials) {
    EXPECT_TRUE(is_pale(at(draw(square(), {turned()}), 0, 0.5)));
    Asset both = square();
    both.materials[0].double_sided = true;
    const Pixel front = at(draw(both), 0, 0.5), back = at(draw(both, {turned()}), 0, 0.5);
    EXPECT_TRUE(is_red(back));
    EXPECT_NEAR(front.r, back.r, 2) << "lit alike, by the normal of the side that is seen";
}

TEST(Draw, MirroredInstancesKeepTheirFrontFaces) {
    const Pixel plain = at(draw(square()), 0, 0.5), mirror = at(draw(square(), {mirrored()}), 0, 0.5);
    EXPECT_TRUE(is_red(mirror));
    EXPECT_NEAR(plain.r, mirror.r, 2);
    EXPECT_TRUE(is_pale(at(draw(square(), {turned() * mirrored()}), 0, 0.5)));
}

TEST(Draw, AlphaMasksDiscardPixelsBelowTheCutoff) {
    const auto centre = [](AlphaMode mode, float alpha, float cutoff) {
        Asset asset = square();
        asset.materials[0].alpha_mode = mode;
        asset.materials[0].base_color[3] = alpha;
        asset.materials[0].alpha_cutoff = cutoff;
        return at(draw(asset), 0, 0.5);
    };
    EXPECT_TRUE(is_pale(centre(AlphaMode::kMask, 0.4f, 0.5f)));
    EXPECT_TRUE(is_red(centre(AlphaMode::kMask, 0.4f, 0.3f)));
    EXPECT_TRUE(is_red(centre(AlphaMode::kOpaque, 0.4f, 0.5f)));
}

// The share of the light of the square's inner pixels that changes if the square is drawn, in linear light.
double shown_part(float alpha, uint32_t layers, uint32_t samples) {
    const auto light_of = [&](AlphaMode mode, float of_alpha, uint32_t count) {
        Asset asset = square();
        asset.materials[0].alpha_mode = mode;
        asset.materials[0].base_color[3] = of_alpha;
        const Picture picture = draw(asset, std::vector<Affine>(count), samples);
        double sum = 0;
        for (uint32_t y = kDrawHeight / 2 - 6; y < kDrawHeight / 2 + 6; ++y)
            for (uint32_t x = kDrawWidth / 2 - 6; x < kDrawWidth / 2 + 6; ++x)
                sum += std::pow(picture.rgba[4 * (size_t{y} * kDrawWidth + x) + 1] / 255.0, 2.2);  // green
        return sum;
    };
    const double nothing = light_of(AlphaMode::kBlend, 0, 1), all = light_of(AlphaMode::kOpaque, 1, 1);
    return (light_of(AlphaMode::kBlend, alpha, layers) - nothing) / (all - nothing);
}

TEST(Draw, BlendedMaterialsAreTransparent) {
    for (const uint32_t samples : {1u, 4u}) {
        for (const float alpha : {0.1f, 0.3f, 0.5f, 0.8f})
            EXPECT_NEAR(shown_part(alpha, 1, samples), alpha, 0.04) << alpha << ", samples " << samples;
        EXPECT_NEAR(shown_part(1, 1, samples), 1, 1e-6);
        // Characters behind each other, in any order
        EXPECT_NEAR(shown_part(0.5f, 2, samples), 0.75, 0.1) << samples;
        EXPECT_NEAR(shown_part(0.5f, 4, samples), 0.9375, 0.08) << samples;
    }
}

// Both have instance number 0 in their group or crowd, and section 0.
TEST(Draw, BlendedLayersOfGroupsAndCrowdsShowThroughEachOther) {
    const auto green_of = [](AlphaMode mode, float alpha, uint32_t group_count, uint32_t crowd_count) {
        Asset asset = square();
        asset.materials[0].alpha_mode = mode;
        asset.materials[0].base_color[3] = alpha;
        const Character character = *compile_character(asset, kExact);
        std::vector<Crowd> crowds;
        std::vector<Crowd*> drawn;
        for (uint32_t i = 0; i < crowd_count; ++i)
            crowds.push_back(create({.groups = std::vector<CrowdGroup>(group_count, {&character, 1})}));
        for (Crowd& crowd : crowds) drawn.push_back(&crowd);
        Renderer& renderer = shared_renderer(4, {.shadows = false});
        const Picture picture = renderer.render_frame(drawn, 0, kFront)->picture;
        double sum = 0;
        for (uint32_t y = kDrawHeight / 2 - 6; y < kDrawHeight / 2 + 6; ++y)
            for (uint32_t x = kDrawWidth / 2 - 6; x < kDrawWidth / 2 + 6; ++x)
                sum += std::pow(picture.rgba[4 * (size_t{y} * kDrawWidth + x) + 1] / 255.0, 2.2);
        return sum;
    };
    const double nothing = green_of(AlphaMode::kBlend, 0, 1, 1), all = green_of(AlphaMode::kOpaque, 1, 1, 1);
    const auto part = [&](uint32_t group_count, uint32_t crowd_count) {
        return (green_of(AlphaMode::kBlend, 0.5f, group_count, crowd_count) - nothing) / (all - nothing);
    };
    EXPECT_NEAR(part(1, 1), 0.5, 0.04);
    EXPECT_NEAR(part(2, 1), 0.75, 0.1);
    EXPECT_NEAR(part(1, 2), 0.75, 0.1);
}

// Small squares behind a blended one are seen through the samples that it does not cover, and only there.
TEST(Draw, OcclusionKeepsInstancesBehindBlendedOnes) {
    Asset red = square(), pane = square();
    pane.materials = {{.name = "pane", .base_color = {0, 0.5f, 1, 0.99f}, .alpha_mode = AlphaMode::kBlend}};
    const Character behind = *compile_character(red, kExact), before = *compile_character(pane, kExact);
    constexpr uint32_t kCount = 900;
    std::vector<Affine> places;
    for (uint32_t i = 0; i < kCount; ++i)
        places.push_back(placed({.translation = {0.03f * static_cast<float>(i % 30) - 0.43f,
                                                 0.03f * static_cast<float>(i / 30) + 0.05f, -0.1f},
                                 .scale = {0.03f, 0.03f, 0.03f}}));
    const Camera close{.eye = {0, 0.5f, 1.4f}, .target = {0, 0.5f, 0}};
    std::vector<Picture> pictures;
    for (const bool occlusion : {false, true}) {
        Crowd crowd = create({.groups = {{&before, 1}, {&behind, kCount}}, .culling = Culling{}});
        ASSERT_TRUE(crowd.set_placement(*crowd.instances(1), places));
        Renderer& renderer = shared_renderer(4, {.shadows = false, .occlusion = occlusion});
        for (int frame = 0; frame < 3; ++frame) pictures.push_back(renderer.render_frame(crowd, 0, close)->picture);
    }
    const Picture& without = pictures[2];
    for (size_t i = 3; i < pictures.size(); ++i) EXPECT_EQ(pictures[i].rgba, without.rgba);
    EXPECT_NE(without.rgba, pictured(pane, {Affine{}}, close, {.shadows = false}).rgba) << "some are seen";
}

TEST(Draw, PlacesEveryInstance) {
    const Picture picture = draw(square(), {placed_at(-1.2f), placed_at(1.2f)});
    EXPECT_TRUE(is_red(at(picture, -1.2, 0.5)));
    EXPECT_TRUE(is_red(at(picture, 1.2, 0.5)));
    EXPECT_TRUE(is_pale(at(picture, 0, 0.5)));
}

TEST(Draw, ShowsThePoseOfTheLastUpdate) {
    const Picture picture = draw(square(), {Affine{}}, 1, 1.0);
    EXPECT_TRUE(is_red(at(picture, 1, 0.5)));
    EXPECT_TRUE(is_pale(at(picture, 0, 0.5)));
}

TEST(Draw, MapsTextures) {
    Asset asset = square();
    asset.materials[0].base_color = {1, 1, 1, 1};
    asset.materials[0].image = 0;
    asset.images = {
        {.name = "quarters",
         .encoded = png_bytes({2, 2, {255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 255, 255, 255, 255, 255}})}};
    const Picture picture = draw(asset);
    EXPECT_TRUE(is_red(at(picture, -0.25, 0.75)));
    EXPECT_TRUE(is_green(at(picture, 0.25, 0.75)));
    EXPECT_TRUE(is_blue(at(picture, -0.25, 0.25)));
    EXPECT_TRUE(is_pale(at(picture, 0.25, 0.25)));
}

TEST(Draw, MultipliesFactorTextureAndVertexColor) {
    Asset asset = square();
    asset.materials[0].base_color = {1, 1, 0, 1};
    asset.materials[0].image = 0;
    asset.images = {{.name = "magenta", .encoded = png_bytes({1, 1, {255, 0, 255, 255}})}};
    EXPECT_TRUE(is_red(at(draw(asset), 0, 0.5)));
    asset.materials[0].base_color = {1, 1, 1, 1};
    asset.meshes[0].primitives[0].colors.assign(4, {0, 1, 1, 1});
    EXPECT_TRUE(is_blue(at(draw(asset), 0, 0.5)));
}

// One target moves the square aside, one only turns its normals away from the light.
TEST(Draw, AppliesMorphs) {
    Asset asset = square();
    asset.meshes[0].weights = {0, 0};
    asset.meshes[0].primitives[0].targets = {{.positions = std::vector<Vec3<float>>(4, {-1, 0, 0}), .normals = {}},
                                             {.positions = {}, .normals = std::vector<Vec3<float>>(4, {1, -1, -1})}};
    const auto with = [&](float first, float second) {
        asset.clips[0].morph_tracks = {
            {.node = 1, .interpolation = Interpolation::kLinear, .times_s = {0, 1}, .values = {0, 0, first, second}}};
        return draw(asset, {placed_at(-1), Affine{}}, 1, 1.0);  // the clip moves the squares by 1
    };
    const Picture still = with(0, 0), moved = with(1, 0), turned_away = with(0, 1);
    EXPECT_TRUE(is_red(at(still, 1, 0.5)) && is_red(at(still, 0, 0.5)) && is_pale(at(still, -1, 0.5)));
    EXPECT_TRUE(is_pale(at(moved, 1, 0.5)) && is_red(at(moved, 0, 0.5)) && is_red(at(moved, -1, 0.5)));
    EXPECT_LT(at(turned_away, 0, 0.5).r + 20, at(still, 0, 0.5).r) << "darker";
    EXPECT_EQ(draw(square(), {placed_at(-1), Affine{}}, 1, 1.0).rgba, still.rgba) << "weights of 0 change nothing";
}

TEST(Draw, DrawsBrokenImagesWhite) {
    Asset asset = square();
    asset.materials[0].image = 0;
    std::vector<std::byte> torn = png_bytes(gradient(8, 8));
    torn.resize(torn.size() / 2);
    for (const auto& encoded : {std::vector<std::byte>{}, std::vector<std::byte>(9, std::byte{7}), torn}) {
        asset.images = {{.name = "broken", .encoded = encoded}};
        EXPECT_TRUE(is_red(at(draw(asset), 0, 0.5)));
    }
}

// A broken normal map is not replaced by a white texture, which would tilt normals.
TEST(Draw, BrokenNormalMapsChangeNothing) {
    Asset asset = square();
    const Picture without = draw(asset);
    asset.materials[0].normal_image = 0;
    asset.images = {{.name = "broken", .encoded = std::vector<std::byte>(9, std::byte{7})}};
    EXPECT_EQ(draw(asset).rgba, without.rgba);
}

PFN_vkQueueSubmit2 driver_submit = nullptr;

// A texture can cause the uploads before it to be submitted. If that fails, the error does not name the texture.
TEST(Draw, AFailedUploadIsNotBlamedOnTheNextTexture) {
    const Device device = another_device();
    Gpu& gpu = *device.gpu();
    Uploads uploads(device.gpu());
    const Buffer before = upload(uploads, "before", std::vector(Uploads::kMaxStaged_bytes, std::byte{1}));
    driver_submit = std::exchange(gpu.vk.vkQueueSubmit2, [](VkQueue, uint32_t, const VkSubmitInfo2*, VkFence) {
        return VK_ERROR_OUT_OF_DEVICE_MEMORY;
    });
    const AssetImage next{.name = "next", .encoded = png_bytes(gradient(8, 8))};
    std::vector<std::string> warnings;
    uint64_t room_bytes = kTexturesLimit_bytes;
    TextureAccount account{warnings, room_bytes, gpu.values};
    const Result<void> made = as_result([&] { make_texture(uploads, next, true, account); });
    ASSERT_FALSE(made);
    EXPECT_EQ(made.error().code, ErrorCode::kOutOfMemory);
    EXPECT_EQ(made.error().text().find("next"), std::string::npos) << made.error().text();
    EXPECT_TRUE(warnings.empty());
    gpu.vk.vkQueueSubmit2 = driver_submit;
    EXPECT_TRUE(make_texture(uploads, next, true, account));
}

// Images whose headers claim a large size but hold no pixels. Each takes a sixth of the limit even before it is
// decoded.
TEST(Draw, TextureMemoryOfACrowdIsLimited) {
    std::vector<std::byte> encoded = png_bytes({1, 1, {255, 255, 255, 255}});
    // 8192, in the header
    for (const size_t side : {16u, 20u}) encoded[side + 2] = std::byte{0x20}, encoded[side + 3] = std::byte{0};
    Asset asset = square();
    asset.images.assign(4, {.name = "vast", .encoded = encoded});
    AssetMaterial& material = asset.materials[0];
    material.image = 0, material.metallic_roughness_image = 1, material.normal_image = 2, material.emissive_image = 3;
    const Result<Character> character = compile_character(asset, kExact);
    ASSERT_TRUE(character);
    Result<Crowd> crowd = Crowd::create(test_device(), {.groups = {{&*character, 1}, {&*character, 1}}});
    ASSERT_TRUE(crowd && crowd->update(0));
    const Result<RenderResult> result = shared_renderer(1).render(*crowd,
                                                                  {.eye = {0, 0.5f, 5}, .target = {0, 0.5f, 0}});
    ASSERT_TRUE(result);
    const auto warned = [&](const char* of) {
        return std::ranges::count_if(result->warnings, [&](const std::string& warning) {
            return warning.find(of) != std::string::npos && warning.ends_with("drawn white");
        });
    };
    EXPECT_EQ(warned("cannot be decoded"), 6);
    EXPECT_EQ(warned("limit of 2147483648 bytes"), 2);
}

// Three joints in a row behind the square. Their lines are drawn over it.
TEST(Draw, SkeletonsAreDrawnOverTheMeshColoredByLevel) {
    Asset asset = square();
    asset.clips.clear();
    asset.nodes[0].parent_from_node.translation = {0, 0, 0};
    asset.nodes.push_back({.name = "second", .parent = 0, .parent_from_node = {.translation = {0, 0.6, -0.3}}});
    asset.nodes.push_back({.name = "third", .parent = 2, .parent_from_node = {.translation = {0.4, 0, 0}}});
    asset.skins[0].joints = {0, 2, 3};
    asset.skins[0].inverse_binds.resize(3);
    const Camera camera{.eye = {0, 0.5f, 2}, .target = {0, 0.5f, 0}};
    for (const CrowdSettings& settings : {CrowdSettings{.keep_model_matrices = true},
                                          CrowdSettings{.keep_model_matrices = true, .culling = Culling{}}}) {
        const Picture picture = pictured(asset, {Affine{}}, camera, {.skeletons = true}, settings);
        const Pixel first = seen_at(picture, camera, {0, 0.3, -0.15}),
                    second = seen_at(picture, camera, {0.2, 0.6, -0.3});
        EXPECT_EQ(std::tuple(first.r, first.g), std::tuple(0, 255)) << "the second of three levels";
        EXPECT_NEAR(first.b, encoded(0.4), 1);
        EXPECT_NEAR(second.r, encoded(0.8), 1) << "the third";
        EXPECT_EQ(std::tuple(second.g, second.b), std::tuple(0, 255));
        EXPECT_TRUE(is_red(seen_at(picture, camera, {0.2, 0.3, 0}))) << "beside them the square";
    }
    const Result<Character> character = compile_character(square(), kExact);
    Crowd unseen = crowd_of(*character, {.keep_model_matrices = true, .culling = Culling{}});
    const CrowdView away = *view_of({.eye = {0, 0.5f, 5}, .target = {0, 0.5f, 9}}, kDrawWidth, kDrawHeight,
                                    world_bounds(unseen));
    ASSERT_TRUE(unseen.update(0, &away));
    const Picture with_lines = shared_renderer(1, {.skeletons = true, .bounds = true}).render(unseen, kFront)->picture,
                  without = shared_renderer(1).render(unseen, kFront)->picture;
    EXPECT_EQ(with_lines.rgba, without.rgba) << "what is not listed has none";

    Crowd crowd = crowd_of(*character);
    const Result<RenderResult> result = shared_renderer(1, {.skeletons = true}).render_frame(crowd, 0, kFront);
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().text(),
              "skeletons: the crowd keeps no model matrices; set CrowdSettings::keep_model_matrices");
}

TEST(Draw, BoundsOptionDrawsTheCullingBoxes) {
    const Result<Character> character = compile_character(square(), kExact);
    const Result<Crowd> crowd = Crowd::create(test_device(), {.groups = {{&*character, 1}}});
    const Group& group = crowd->state().groups[0];
    const Vec3<double> middle_of_edge{group.posed_max.x, group.posed_max.y,
                                      (group.posed_min.z + group.posed_max.z) / 2.0},
        low{(group.posed_min.x + group.posed_max.x) / 2.0, group.posed_min.y, group.posed_max.z};
    const Camera camera{.eye = {2, 2, 3}, .target = {0.4f, 0.5f, 0}};
    for (const bool culls : {false, true}) {
        const Picture with = pictured(square(), {Affine{}}, camera, {.bounds = true},
                                      {.culling = culls ? std::optional(Culling{}) : std::nullopt});
        for (const Vec3<double>& point : {middle_of_edge, low}) {
            const Pixel p = seen_at(with, camera, point);
            EXPECT_NEAR(p.r, 255, 1);
            EXPECT_NEAR(p.g, encoded(0.75), 1);
            EXPECT_NEAR(p.b, encoded(0.1), 1);
        }
    }
}

TEST(WorldBounds, HoldEveryInstance) {
    const Result<Character> character = compile_character(square(), kExact);
    ASSERT_TRUE(character);
    Result<Crowd> crowd = Crowd::create(test_device(), {.groups = {{&*character, 1}, {&*character, 2}}});
    ASSERT_TRUE(crowd);
    const std::vector<Affine> placements{placed_at(-3), turned(),
                                         placed({.translation = {0, 2, 4}, .scale = {2, 3, 1}})};
    ASSERT_TRUE(crowd->set_placement(crowd->instances(), placements));
    const Bounds bounds = world_bounds(*crowd);
    EXPECT_NEAR(bounds.min.x, -3.5, 1e-6);
    EXPECT_NEAR(bounds.max.x, 1, 1e-6);
    EXPECT_NEAR(bounds.min.y, 0, 1e-6);
    EXPECT_NEAR(bounds.max.y, 5, 1e-6);
    EXPECT_NEAR(bounds.min.z, 0, 1e-6);
    EXPECT_NEAR(bounds.max.z, 4, 1e-6);
}

}  // namespace
}  // namespace throng
