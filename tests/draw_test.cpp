// The draw: a square whose colour says what was drawn.
#include <throng/draw.h>

#include "base/failure.h"
#include "crowd/crowd_state.h"
#include "draw/light_reference.h"
#include "draw/scene.h"
#include "draw/textures.h"
#include "gpu/barrier.h"
#include "gpu/buffer.h"
#include "tests/ball.h"
#include "tests/png.h"
#include "tests/projection.h"
#include "tests/subset.h"
#include "tests/test_device.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <stdexcept>

namespace throng {
namespace {

// Instrumented, those left out take too long.
const test::InSubset kDrawInSubsets({test::Subset::kGpuAssisted},
                                    {"Draw.*", "Renderer.*", "-Draw.LeavesOutWhatAMaskSays",
                                     "-Draw.WhatIsBlendedIsSeenThrough", "-Draw.MirroredInstancesKeepTheirFrontFaces",
                                     "-Draw.DrawsBrokenImagesWhite", "-Renderer.FramesFollowEachOther"}),
    kDrawNatively({test::Subset::kNative}, {"Draw.*", "Renderer.*", "-Draw.AFailedUploadIsNotBlamedOnTheNextTexture"});

// Shaders where the device has some: on native devices these are tests of the native renderer.
DrawPath device_path() { return test_device().gpu()->is_native() ? DrawPath::kNative : DrawPath::kDevice; }

using test::gradient, test::png_bytes, test::project;

constexpr uint32_t kDrawWidth = 64, kDrawHeight = 48;

// A red square of side 1 in the plane z = 0 that faces +z and stands on the ground, with one joint; its clip moves it
// to x = 1 at 1 s.
Asset square() {
    Asset asset;
    asset.name = "square";
    asset.nodes = {{.name = "joint"}, {.name = "mesh"}};
    asset.skins = {{.name = "skin", .joints = {0}, .inverse_binds = {Affine{}}}};
    AssetPrimitive primitive;
    primitive.material = 0;
    primitive.positions = {{-0.5f, 0, 0}, {0.5f, 0, 0}, {0.5f, 1, 0}, {-0.5f, 1, 0}};
    primitive.normals.assign(4, {0, 0, 1});
    primitive.texcoords = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};  // the image's first row is at the top
    primitive.influence_count = 4;
    for (int v = 0; v < 4; ++v) {
        primitive.influence_joints.insert(primitive.influence_joints.end(), {0, 0, 0, 0});
        primitive.influence_weights.insert(primitive.influence_weights.end(), {1, 0, 0, 0});
    }
    primitive.indices = {0, 1, 2, 0, 2, 3};
    asset.meshes = {{.name = "mesh", .primitives = {primitive}}};
    asset.mesh_instances = {{.node = 1, .mesh = 0, .skin = 0}};
    asset.materials = {{.name = "red", .base_color = {0.8f, 0.02f, 0.02f, 1}}};
    asset.clips = {
        {.name = "move",
         .duration_s = 1,
         .tracks = {
             {.node = 0, .target = TrackTarget::kTranslation, .times_s = {0, 1}, .values = {0, 0, 0, 1, 0, 0}}}}};
    return asset;
}

Affine placed(Trs<float> placement) { return to_affine(placement); }
Affine placed_at(float x) { return placed({.translation = {x, 0, 0}}); }
Affine turned() { return placed({.rotation = axis_angle(Vec3<float>{0, 1, 0}, std::numbers::pi_v<float>)}); }
Affine mirrored() { return placed({.scale = {-1, 1, 1}}); }

// Made once for each number of samples, since making pipelines takes most of a small picture's time.
Renderer& shared_renderer(uint32_t samples, const DrawOptions& options = {}) {
    static std::map<uint32_t, Renderer> renderers;
    if (!renderers.contains(samples)) {
        Result<Renderer> renderer = Renderer::create(
            test_device(), {.width = kDrawWidth, .height = kDrawHeight, .samples = samples, .path = device_path()});
        if (!renderer) throw std::runtime_error(renderer.error().text());
        renderers.emplace(samples, std::move(*renderer));
    }
    Renderer& renderer = renderers.at(samples);
    EXPECT_TRUE(renderer.set_options(options));
    return renderer;
}

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
    const Result<RenderResult> result = shared_renderer(samples).render(
        *crowd, {.eye = {0, 0.5f, 5}, .target = {0, 0.5f, 0}, .vertical_field_of_view_rad = 0.7f});
    EXPECT_TRUE(result) << (result ? "" : result.error().text());
    EXPECT_GE(result->draw_ms, 0);
    EXPECT_EQ(result->picture.rgba.size(), kDrawWidth * kDrawHeight * 4);
    return result->picture;
}

struct Pixel {
    int r, g, b;
};

// The pixel where the plane z = 0 is at x, y.
Pixel at(const Picture& picture, double x, double y) {
    const Vec3<double> seen = project({.eye = {0, 0.5f, 5}, .target = {0, 0.5f, 0}, .vertical_field_of_view_rad = 0.7f},
                                      double{kDrawWidth} / kDrawHeight, {x, y, 0});
    const auto column = static_cast<size_t>((seen.x + 1) / 2 * kDrawWidth),
               row = static_cast<size_t>((1 - seen.y) / 2 * kDrawHeight);
    const uint8_t* p = &picture.rgba[(row * kDrawWidth + column) * 4];
    EXPECT_EQ(p[3], 255);
    return {p[0], p[1], p[2]};
}

bool is_red(const Pixel& p) { return p.r > 100 && p.r > 2 * p.g && p.r > 2 * p.b; }
bool is_green(const Pixel& p) { return p.g > 100 && p.g > 2 * p.r && p.g > 2 * p.b; }
bool is_blue(const Pixel& p) { return p.b > 100 && p.b > 2 * p.r && p.b > 2 * p.g; }
// The ground, the sky, white
bool is_pale(const Pixel& p) { return std::max({p.r, p.g, p.b}) - std::min({p.r, p.g, p.b}) < 90; }

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

TEST(Draw, LeavesOutWhatAMaskSays) {
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

// What of the square's inner pixels is not as without it, by linear light.
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

TEST(Draw, WhatIsBlendedIsSeenThrough) {
    for (const uint32_t samples : {1u, 4u}) {
        for (const float alpha : {0.1f, 0.3f, 0.5f, 0.8f})
            EXPECT_NEAR(shown_part(alpha, 1, samples), alpha, 0.04) << alpha << ", samples " << samples;
        EXPECT_NEAR(shown_part(1, 1, samples), 1, 1e-6);
        // Characters behind each other, in any order
        EXPECT_NEAR(shown_part(0.5f, 2, samples), 0.75, 0.1) << samples;
        EXPECT_NEAR(shown_part(0.5f, 4, samples), 0.9375, 0.08) << samples;
    }
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

// Nor does a normal map that is white instead tilt normals.
TEST(Draw, BrokenNormalMapsChangeNothing) {
    Asset asset = square();
    const Picture without = draw(asset);
    asset.materials[0].normal_image = 0;
    asset.images = {{.name = "broken", .encoded = std::vector<std::byte>(9, std::byte{7})}};
    EXPECT_EQ(draw(asset).rgba, without.rgba);
}

PFN_vkQueueSubmit2 driver_submit = nullptr;

// A texture that makes those before it be submitted is not taken for the cause where that fails.
TEST(Draw, AFailedUploadIsNotBlamedOnTheNextTexture) {
    const Device device = another_device();
    Gpu& gpu = *device.gpu();
    Uploads uploads(device.gpu());
    const Buffer before = upload(uploads, "before", std::vector(Uploads::kMostStaged_bytes, std::byte{1}));
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

// Images that say they are large, and have no pixels: each takes a sixth of what there is room for, before it is
// decoded.
TEST(Draw, TexturesOfACrowdHaveALimit) {
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

TEST(Renderer, RefusesWhatTheDeviceCannotDo) {
    const DrawPath path = device_path();
    const Result<Renderer> empty = Renderer::create(test_device(), {.width = 0, .height = 5, .path = path});
    ASSERT_FALSE(empty);
    EXPECT_EQ(empty.error().code, ErrorCode::kInvalidArgument);
    const Result<Renderer> huge = Renderer::create(test_device(), {.width = 1u << 20, .height = 5, .path = path});
    ASSERT_FALSE(huge);
    EXPECT_EQ(huge.error().code, ErrorCode::kLimit);
    const char* const limit = path == DrawPath::kNative ? "exceeds the 16384 pixels" : "exceeds the device's";
    EXPECT_NE(huge.error().text().find(limit), std::string::npos) << huge.error().text();
}

TEST(Renderer, RefusesACameraThatSeesNothing) {
    const Result<Character> character = compile_character(square(), kExact);
    ASSERT_TRUE(character);
    Result<Crowd> crowd = Crowd::create(test_device(), {.groups = {{&*character, 1}}});
    ASSERT_TRUE(crowd && crowd->update(0));
    Renderer& renderer = shared_renderer(1);
    const float infinity = std::numeric_limits<float>::infinity();
    for (const Camera& camera : {Camera{.eye = {1, 1, 1}, .target = {1, 1, 1}}, Camera{.eye = {infinity, 0, 0}},
                                 Camera{.vertical_field_of_view_rad = 0}, Camera{.vertical_field_of_view_rad = 4}}) {
        const Result<RenderResult> result = renderer.render(*crowd, camera);
        ASSERT_FALSE(result);
        EXPECT_EQ(result.error().code, ErrorCode::kInvalidArgument);
    }
    const Camera down{.eye = {0, 5, 0}, .target = {0, 0, 0}};
    EXPECT_TRUE(renderer.render(*crowd, down)) << "straight down is a direction, too";
}

constexpr Camera kFront{.eye = {0, 0.5f, 5}, .target = {0, 0.5f, 0}, .vertical_field_of_view_rad = 0.7f};

Crowd crowd_of(const Character& character, const CrowdSettings& settings = {}) {
    CrowdSettings with_group = settings;
    with_group.groups = {{&character, 3}};
    Result<Crowd> crowd = Crowd::create(test_device(), with_group);
    EXPECT_TRUE(crowd) << (crowd ? "" : crowd.error().text());
    const std::vector<Affine> placements{placed_at(-1.5f), placed_at(0.5f), placed_at(40)};
    const std::vector<Playback> playback(3, {.first = {.clip = 0, .speed = 1}});
    EXPECT_TRUE(crowd->set_placement(crowd->instances(), placements) &&
                crowd->set_playback(crowd->instances(), playback));
    return std::move(*crowd);
}

Renderer renderer_of(RendererSettings settings = {.width = kDrawWidth, .height = kDrawHeight}) {
    settings.path = device_path();
    Result<Renderer> renderer = Renderer::create(test_device(), settings);
    EXPECT_TRUE(renderer) << (renderer ? "" : renderer.error().text());
    return std::move(*renderer);
}

// Two frames recorded into one command buffer, so that nothing but barriers is between them, for crowds that cull and
// keep two sets of matrices, or neither.
TEST(Renderer, FramesFollowEachOther) {
    const Result<Character> character = compile_character(square(), kExact);
    ASSERT_TRUE(character);
    Renderer one = renderer_of();
    Renderer& other = shared_renderer(4);
    for (const CrowdSettings& settings :
         {CrowdSettings{}, CrowdSettings{.keep_previous_matrices = true, .culling = Culling{}}}) {
        Crowd apart = crowd_of(*character, settings), together = crowd_of(*character, settings),
              recorded = crowd_of(*character, settings);
        std::vector<Picture> expected;
        for (int frame = 0; frame < 2; ++frame) {
            ASSERT_TRUE(apart.update(0.4f));
            expected.push_back(one.render(apart, kFront)->picture);
            const Result<RenderResult> result = other.render_frame(together, 0.4f, kFront);
            ASSERT_TRUE(result) << result.error().text();
            EXPECT_EQ(result->picture.rgba, expected.back().rgba) << "frame " << frame;
            EXPECT_EQ(result->draw_ms, other.draw_ms());
        }
        EXPECT_NE(expected[0].rgba, expected[1].rgba);

        if (test_device().gpu()->is_native()) continue;
        const std::shared_ptr<Gpu> gpu = test_device().gpu();
        std::array<Buffer, 2> copies;
        for (Buffer& copy : copies) copy = Buffer(gpu, "copy", expected[0].rgba.size(), 0, MemoryKind::kReadback);
        gpu->submit_and_wait([&](VkCommandBuffer commands) {
            for (const Buffer& copy : copies) {
                const Result<void> result = one.record(commands, recorded, 0.4f, kFront);
                ASSERT_TRUE(result) << result.error().text();
                VkBufferImageCopy region{};
                region.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
                region.imageExtent = {kDrawWidth, kDrawHeight, 1};
                gpu->vk.vkCmdCopyImageToBuffer(commands, one.picture(), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                                               copy.handle(), 1, &region);
            }
            memory_barrier(*gpu, commands, kTransferWrite, kHostRead);
        });
        for (size_t frame = 0; frame < 2; ++frame)
            EXPECT_EQ(std::memcmp(copies[frame].mapped(), expected[frame].rgba.data(), expected[frame].rgba.size()), 0)
                << "frame " << frame;
    }
}

TEST(Renderer, KnowsAnotherCrowdAtTheSamePlace) {
    Asset green = square();
    green.materials[0].base_color = {0.02f, 0.8f, 0.02f, 1};
    const Result<Character> first = compile_character(square(), kExact), second = compile_character(green, kExact);
    ASSERT_TRUE(first && second);
    Renderer& renderer = shared_renderer(4);
    Crowd crowd = crowd_of(*first), kept = crowd_of(*first);
    EXPECT_TRUE(is_red(at(renderer.render_frame(crowd, 0, kFront)->picture, -1.5, 0.5)));
    EXPECT_TRUE(is_red(at(renderer.render_frame(kept, 0, kFront)->picture, -1.5, 0.5)));
    crowd = crowd_of(*second);
    EXPECT_TRUE(is_green(at(renderer.render_frame(crowd, 0, kFront)->picture, -1.5, 0.5)));
    EXPECT_TRUE(is_red(at(renderer.render_frame(kept, 0, kFront)->picture, -1.5, 0.5)));
}

TEST(Renderer, TakesAnotherSize) {
    const Result<Character> character = compile_character(square(), kExact);
    ASSERT_TRUE(character);
    Crowd crowd = crowd_of(*character);
    Renderer renderer = renderer_of({.width = 20, .height = 90});
    ASSERT_TRUE(renderer.render_frame(crowd, 0, kFront));
    ASSERT_TRUE(renderer.resize(kDrawWidth, kDrawHeight));
    EXPECT_TRUE(is_red(at(renderer.render_frame(crowd, 0, kFront)->picture, -1.5, 0.5)));
    const Result<void> empty = renderer.resize(0, 4), huge = renderer.resize(1u << 20, 4);
    ASSERT_FALSE(empty || huge);
    EXPECT_EQ(empty.error().code, ErrorCode::kInvalidArgument);
    EXPECT_EQ(huge.error().code, ErrorCode::kLimit);
    EXPECT_EQ(renderer.render_frame(crowd, 0, kFront)->picture.width, kDrawWidth) << "keeps its size";
}

TEST(Renderer, RefusesWrongOptions) {
    Renderer renderer = renderer_of({.width = 8, .height = 8});
    const float infinity = std::numeric_limits<float>::infinity();
    for (const DrawOptions& options :
         {DrawOptions{.exposure = 0}, DrawOptions{.exposure = infinity}, DrawOptions{.to_sun = {1, 0.04f, 0}},
          DrawOptions{.to_sun = {0, 0, 0}}, DrawOptions{.to_sun = {0, infinity, 0}}, DrawOptions{.lod_pixels = 0},
          DrawOptions{.lod_pixels = infinity}, DrawOptions{.full_rate_pixels = -1},
          DrawOptions{.full_rate_pixels = infinity}, DrawOptions{.budget_ms = -1}}) {
        const Result<void> result = renderer.set_options(options);
        ASSERT_FALSE(result);
        EXPECT_EQ(result.error().code, ErrorCode::kInvalidArgument);
        EXPECT_FALSE(
            Renderer::create(test_device(), {.width = 8, .height = 8, .options = options, .path = device_path()}));
    }
    ASSERT_TRUE(renderer.set_options({.exposure = 2}));
    EXPECT_EQ(renderer.options().exposure, 2);
}

// A crowd of `asset` at `placements`, as `camera` sees it.
Picture pictured(const Asset& asset, const std::vector<Affine>& placements, const Camera& camera,
                 const DrawOptions& options, const CrowdSettings& settings = {}) {
    const Result<Character> character = compile_character(asset, kExact);
    EXPECT_TRUE(character) << (character ? "" : character.error().text());
    CrowdSettings with_group = settings;
    with_group.groups = {{&*character, static_cast<uint32_t>(placements.size())}};
    Result<Crowd> crowd = Crowd::create(test_device(), with_group);
    EXPECT_TRUE(crowd && crowd->set_placement(crowd->instances(), placements));
    Result<RenderResult> result = shared_renderer(1, options).render_frame(*crowd, 0, camera);
    EXPECT_TRUE(result) << (result ? "" : result.error().text());
    return std::move(result->picture);
}

Pixel seen_at(const Picture& picture, const Camera& camera, const Vec3<double>& point) {
    const Vec3<double> seen = project(camera, static_cast<double>(picture.width) / picture.height, point);
    const auto column = static_cast<size_t>((seen.x + 1) / 2 * picture.width),
               row = static_cast<size_t>((1 - seen.y) / 2 * picture.height);
    const uint8_t* p = &picture.rgba.at((row * picture.width + column) * 4);
    return {p[0], p[1], p[2]};
}
int sum_of(const Pixel& p) { return p.r + p.g + p.b; }

// The sun stands behind the camera of kFront, half way up: a square throws a shadow of its size behind it.
TEST(Draw, ShadowsFallOnTheGroundAndOnOthers) {
    const DrawOptions lit{.shadows = false, .to_sun = {0, 1, 1}}, shadowed{.to_sun = {0, 1, 1}};
    const std::vector<Affine> places{Affine{}, placed({.translation = {0, 0, -0.6f}})};
    const Camera above{.eye = {0, 4, -4}, .target = {0, 0, -0.5f}},
        beside{.eye = {3, 1, 2}, .target = {0, 0.5f, -0.3f}};
    const auto darkens = [&](const Picture& without_any, const Picture& with, const Camera& camera,
                             const Vec3<double>& point) {
        const int without = sum_of(seen_at(without_any, camera, point)), shaded = sum_of(seen_at(with, camera, point));
        EXPECT_TRUE(shaded == without || shaded < 0.8 * without) << shaded << " of " << without;
        return shaded < without;
    };
    const Picture one = pictured(square(), {Affine{}}, above, lit), two = pictured(square(), places, beside, lit);
    for (const bool culls : {false, true}) {
        const Picture one_shadowed = pictured(square(), {Affine{}}, above, shadowed,
                                              {.culling = culls ? std::optional(Culling{}) : std::nullopt}),
                      two_shadowed = pictured(square(), places, beside, shadowed,
                                              {.culling = culls ? std::optional(Culling{}) : std::nullopt});
        EXPECT_TRUE(darkens(one, one_shadowed, above, {0, 0, -0.5})) << "the ground behind";
        EXPECT_FALSE(darkens(one, one_shadowed, above, {0, 0, -1.2})) << "beyond the shadow";
        EXPECT_FALSE(darkens(one, one_shadowed, above, {0.7, 0, -0.5})) << "beside it";
        EXPECT_TRUE(darkens(two, two_shadowed, beside, {0, 0.2, -0.6})) << "the square behind, at its foot";
        EXPECT_FALSE(darkens(two, two_shadowed, beside, {0, 0.7, -0.6})) << "and above";
        EXPECT_FALSE(darkens(two, two_shadowed, beside, {0.2, 0.5, 0})) << "a surface does not shadow itself";
    }
    Asset masked = square();
    masked.materials[0].alpha_mode = AlphaMode::kMask;
    masked.materials[0].base_color[3] = 0.2f;
    EXPECT_FALSE(darkens(one, pictured(masked, {Affine{}}, above, shadowed), above, {0, 0, -0.5}))
        << "what a mask leaves out throws none";
}

double linear(double srgb) { return srgb <= 0.04045 ? srgb / 12.92 : std::pow((srgb + 0.055) / 1.055, 2.4); }
double encoded(double color) {
    return 255 * (color <= 0.0031308 ? 12.92 * color : 1.055 * std::pow(color, 1 / 2.4) - 0.055);
}

// A square with a material, whose images are of one pixel each, and the normal that these give it.
struct LitSquare {
    LitSquare(const char* name, const AssetMaterial& material_in,
              const std::vector<std::array<uint8_t, 4>>& images_in = {}, const Vec3<double>& normal_in = {0, 0, 1})
        : what(name), material(material_in), images(images_in), normal(normal_in) {}

    std::string what;
    AssetMaterial material;
    std::vector<std::array<uint8_t, 4>> images;
    Vec3<double> normal;
};

// Of squares side by side, some pixels of each.
void expect_lit_as_the_reference(const std::vector<LitSquare>& squares, const DrawOptions& options) {
    std::vector<Character> characters;
    std::vector<Affine> placements;
    for (const LitSquare& lit : squares) {
        Asset asset = square();
        asset.materials = {lit.material};
        for (const auto& rgba : lit.images)
            asset.images.push_back({.name = "image", .encoded = png_bytes({1, 1, {rgba.begin(), rgba.end()}})});
        placements.push_back(placed_at(1.1f * static_cast<float>(placements.size())));
        characters.push_back(*compile_character(asset, kExact));
    }
    CrowdSettings settings;
    for (const Character& character : characters) settings.groups.push_back({&character, 1});
    Result<Crowd> crowd = Crowd::create(test_device(), settings);
    ASSERT_TRUE(crowd && crowd->set_placement(crowd->instances(), placements));
    const float middle = placements.back().row[0][3] / 2;
    const Camera camera{.eye = {middle + 0.9f, 1.2f, 2.4f + 1.3f * middle}, .target = {middle, 0.5f, 0}};
    const Picture picture = shared_renderer(1, options).render_frame(*crowd, 0, camera)->picture;
    const io::DrawScene scene = make_scene(std::array{&crowd->state()}, camera, {kDrawWidth, kDrawHeight}, 512,
                                           options);
    const auto row = [](const io::vec4& v) { return Vec3<double>{v.x, v.y, v.z}; };
    for (size_t i = 0; i < squares.size(); ++i) {
        const auto& [what, material, images, normal] = squares[i];
        LitSurface surface{.normal = normal,
                           .albedo = {material.base_color[0], material.base_color[1], material.base_color[2]},
                           .metallic = material.metallic,
                           .roughness = material.roughness,
                           .emissive = {material.emissive[0], material.emissive[1], material.emissive[2]}};
        if (material.metallic_roughness_image != kNone)
            surface.metallic *= images[0][2] / 255.0, surface.roughness *= images[0][1] / 255.0;
        if (material.emissive_image != kNone)
            surface.emissive = Vec3<double>{linear(images[0][0] / 255.0), linear(images[0][1] / 255.0),
                                            linear(images[0][2] / 255.0)} *
                               0.5;
        const double map_occlusion = material.occlusion_image == kNone
                                         ? 1
                                         : 1 + material.occlusion_strength * (images[0][0] / 255.0 - 1);
        for (const auto& [x, y] : {std::pair(-0.25, 0.15), {0.2, 0.8}, {0.0, 0.5}}) {
            const Vec3<double> seen = project(camera, double{kDrawWidth} / kDrawHeight,
                                              {placements[i].row[0][3] + x, y, 0});
            const double column = std::floor((seen.x + 1) / 2 * kDrawWidth),
                         line = std::floor((1 - seen.y) / 2 * kDrawHeight);
            // The place of the middle of the pixel, on the plane z = 0.
            const Vec3<double> eye = row(scene.eye), ray = row(scene.forward) +
                                                           row(scene.right) * ((column + 0.5) / kDrawWidth * 2 - 1) +
                                                           row(scene.down) * ((line + 0.5) / kDrawHeight * 2 - 1);
            surface.place = eye + ray * (-eye.z / ray.z);
            const double t = std::clamp((surface.place.y - scene.ground.y) / scene.ground.w / 0.25, 0.0, 1.0);
            surface.occlusion = (0.5 + 0.5 * t * t * (3 - 2 * t)) * map_occlusion;
            const Vec3<double> expected = pictured_reference(scene, surface.place,
                                                             reflected_light_reference(scene, surface, 1));
            const uint8_t* p =
                &picture.rgba[(static_cast<size_t>(line) * kDrawWidth + static_cast<size_t>(column)) * 4];
            EXPECT_NEAR(p[0], encoded(std::clamp(expected.x, 0.0, 1.0)), 1.2) << what << " at " << x << ", " << y;
            EXPECT_NEAR(p[1], encoded(std::clamp(expected.y, 0.0, 1.0)), 1.2) << what;
            EXPECT_NEAR(p[2], encoded(std::clamp(expected.z, 0.0, 1.0)), 1.2) << what;
        }
    }
}

TEST(Draw, MaterialsAreLitAsTheReferenceSays) {
    const LitSquare rough("rough", {.base_color = {0.5f, 0.3f, 0.2f, 1}, .metallic = 0, .roughness = 1}),
        polished("polished", {.base_color = {0.1f, 0.3f, 0.2f, 1}, .metallic = 0, .roughness = 0.2f}),
        metal("metal", {.base_color = {0.9f, 0.6f, 0.2f, 1}, .metallic = 1, .roughness = 0.4f}),
        half("half metal", {.base_color = {0.2f, 0.6f, 0.2f, 1}, .metallic = 0.5f, .roughness = 0.7f}),
        shining("shining",
                {.base_color = {0.1f, 0.1f, 0.1f, 1}, .metallic = 0, .roughness = 1, .emissive = {0.1f, 3, 0.2f}}),
        maps("maps of metal and occlusion",
             {.metallic = 0.9f,
              .roughness = 0.8f,
              .metallic_roughness_image = 0,
              .occlusion_image = 0,
              .occlusion_strength = 0.5f},
             {{51, 153, 204, 255}}),
        emission("map of emission",
                 {.base_color = {0, 0, 0, 1},
                  .metallic = 0,
                  .roughness = 1,
                  .emissive = {0.5f, 0.5f, 0.5f},
                  .emissive_image = 0},
                 {{188, 50, 100, 255}}),
        normals("map of normals",
                {.base_color = {0.6f, 0.6f, 0.6f, 1},
                 .metallic = 0,
                 .roughness = 0.5f,
                 .normal_image = 0,
                 .normal_scale = 0.8f},
                {{200, 60, 220, 255}},
                normalized(Vec3<double>{0.8 * (400.0 / 255 - 1), 0.8 * (120.0 / 255 - 1), 440.0 / 255 - 1}));
    expect_lit_as_the_reference({rough, shining, maps, emission}, {});
    expect_lit_as_the_reference({polished, metal, half, normals},
                                {.fog = false, .exposure = 1.3f, .to_sun = {0.6f, 0.3f, 1}});
}

// Where the sun is behind the eye, the half-way vector is the one to the eye, and their product may round to more
// than 1.
TEST(Draw, LooksAlongTheSun) {
    const Vec3<float> to_sun = normalized(Vec3<float>{0.3f, 0.4f, 1});
    const Camera camera{
        .eye = Vec3<float>{0, 0.5f, 0} + to_sun * 5.0f, .target = {0, 0.5f, 0}, .vertical_field_of_view_rad = 1e-3f};
    const Picture picture = pictured(square(), {Affine{}}, camera, {.shadows = false, .to_sun = to_sun});
    const Pixel first = seen_at(picture, camera, {0, 0.5, 0});
    for (size_t i = 0; i < picture.rgba.size(); i += 4) ASSERT_NEAR(picture.rgba[i], first.r, 2) << "pixel " << i / 4;
}

TEST(Draw, FogGrowsWithDistance) {
    const Camera camera{.eye = {0, 0.5f, 5}, .target = {0, 0.5f, 0}};
    const std::vector<Affine> places{placed({.translation = {-0.8f, 0, 0}}),
                                     placed({.translation = {2, 0, -10}, .scale = {2, 2, 2}})};
    const Picture clear = pictured(square(), places, camera, {.fog = false}),
                  foggy = pictured(square(), places, camera, {});
    const auto change = [&](const Vec3<double>& point) {
        return sum_of(seen_at(foggy, camera, point)) - sum_of(seen_at(clear, camera, point));
    };
    EXPECT_GT(change({2, 1.6, -10}), change({-0.8, 0.8, 0}) + 10);
    EXPECT_GE(change({-0.8, 0.8, 0}), 0);
}

// Three joints in a row, behind the square: lines are drawn over it.
TEST(Draw, SkeletonsShowLevelsOverTheMesh) {
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

TEST(Draw, BoundsAreTheBoxesOfCulling) {
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
