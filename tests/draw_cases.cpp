#include "tests/draw_cases.h"

#include "gpu/gpu.h"
#include "tests/test_device.h"
#include "tests/projection.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <stdexcept>

namespace throng::test {

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

Affine placed(const Trs<float>& placement) { return to_affine(placement); }
Affine turned() { return placed({.rotation = axis_angle(Vec3<float>{0, 1, 0}, std::numbers::pi_v<float>)}); }
Affine mirrored() { return placed({.scale = {-1, 1, 1}}); }

DrawPath device_path() { return test_device().gpu()->is_native() ? DrawPath::kNative : DrawPath::kDevice; }

Renderer& shared_renderer(uint32_t samples, const DrawOptions& options) {
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

Crowd crowd_of(const Character& character, const CrowdSettings& settings) {
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

Picture pictured(const Asset& asset, const std::vector<Affine>& placements, const Camera& camera,
                 const DrawOptions& options, const CrowdSettings& settings) {
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
    EXPECT_EQ(p[3], 255);
    return {p[0], p[1], p[2]};
}

Pixel at(const Picture& picture, double x, double y) { return seen_at(picture, kFront, {x, y, 0}); }
int sum_of(const Pixel& pixel) { return pixel.r + pixel.g + pixel.b; }
bool is_red(const Pixel& p) { return p.r > 100 && p.r > 2 * p.g && p.r > 2 * p.b; }
bool is_green(const Pixel& p) { return p.g > 100 && p.g > 2 * p.r && p.g > 2 * p.b; }
bool is_blue(const Pixel& p) { return p.b > 100 && p.b > 2 * p.r && p.b > 2 * p.g; }
bool is_pale(const Pixel& p) { return std::max({p.r, p.g, p.b}) - std::min({p.r, p.g, p.b}) < 90; }

double linear(double srgb) { return srgb <= 0.04045 ? srgb / 12.92 : std::pow((srgb + 0.055) / 1.055, 2.4); }
double encoded(double light) {
    return 255 * (light <= 0.0031308 ? 12.92 * light : 1.055 * std::pow(light, 1 / 2.4) - 0.055);
}

}  // namespace throng::test
