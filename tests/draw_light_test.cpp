// Light: shadows, materials and fog, on squares.
#include "crowd/crowd_state.h"
#include "draw/light_reference.h"
#include "draw/scene.h"
#include "tests/draw_cases.h"
#include "tests/ball.h"
#include "tests/projection.h"
#include "tests/subset.h"
#include "tests/test_device.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace throng {
namespace {

using namespace test;

const InSubset kDrawLightInSubsets({Subset::kGpuAssisted, Subset::kNative}, {"DrawLight.*"});

// The sun is behind kFront's camera, 45 degrees up: a square casts a shadow of its own size behind it.
TEST(DrawLight, ShadowsFallOnTheGroundAndOnOthers) {
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

TEST(DrawLight, TheGroundDarkensEachCharacterByItsOwnSize) {
    const DrawOptions plain{.shadows = false, .fog = false};
    const Affine giant = placed({.translation = {25, 0, -25}, .scale = {10, 10, 10}});
    Asset grey = square();
    grey.materials = {{.base_color = {0.5f, 0.5f, 0.5f, 1}, .metallic = 0, .roughness = 1}};
    const Picture alone = pictured(grey, {Affine{}}, kFront, plain),
                  beside_a_giant = pictured(grey, {giant, Affine{}}, kFront,
                                            plain);  // the scene's size is that of the first
    for (const double height : {0.2, 0.4, 0.7})
        EXPECT_NEAR(sum_of(at(alone, 0, height)), sum_of(at(beside_a_giant, 0, height)), 3) << height;
    EXPECT_LT(sum_of(at(alone, 0, 0.2)) + 10, sum_of(at(alone, 0, 0.7))) << "near the ground it is darker";
}

// A square with a material, whose images have one pixel each, and the normal that they give it.
struct LitSquare {
    LitSquare(const char* name, const AssetMaterial& material_in,
              const std::vector<std::array<uint8_t, 4>>& images_in = {}, const Vec3<double>& normal_in = {0, 0, 1})
        : what(name), material(material_in), images(images_in), normal(normal_in) {}

    std::string what;
    AssetMaterial material;
    std::vector<std::array<uint8_t, 4>> images;
    Vec3<double> normal;
};

// Draws the squares side by side and compares some pixels of each with the reference.
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
    const io::DrawScene scene = make_scene(bounds_of(std::array{&crowd->state()}, Outliers::kLeftOut), camera,
                                           {kDrawWidth, kDrawHeight}, 512, options);
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
            // The point of the plane z = 0 at the pixel's centre.
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

TEST(DrawLight, MaterialsAreLitAsTheReferenceSays) {
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

// With the sun behind the eye, the half vector equals the direction to the eye, and their dot product may round to more
// than 1.
TEST(DrawLight, LooksAlongTheSun) {
    const Vec3<float> to_sun = normalized(Vec3<float>{0.3f, 0.4f, 1});
    const Camera camera{
        .eye = Vec3<float>{0, 0.5f, 0} + to_sun * 5.0f, .target = {0, 0.5f, 0}, .vertical_field_of_view_rad = 1e-3f};
    const Picture picture = pictured(square(), {Affine{}}, camera, {.shadows = false, .to_sun = to_sun});
    const Pixel first = seen_at(picture, camera, {0, 0.5, 0});
    for (size_t i = 0; i < picture.rgba.size(); i += 4) ASSERT_NEAR(picture.rgba[i], first.r, 2) << "pixel " << i / 4;
}

// Checks every pixel by inverting the mapping from light to colour: neither dark nor bright colours lose 0.04 (Khronos
// PBR Neutral tone mapper).
TEST(DrawLight, AllLightIsMultipliedByTheExposure) {
    const Camera camera{.eye = {0.5f, 1, 4}, .target = {0, 0.5f, 0}};
    Asset grey = square();
    grey.materials[0].base_color = {0.5f, 0.4f, 0.3f, 1};
    const Picture once = pictured(grey, {Affine{}}, camera, {.exposure = 0.4f}),
                  twice = pictured(grey, {Affine{}}, camera, {.exposure = 0.8f});
    constexpr double kLost = 0.04, kDark = 0.08, kBright = 0.76;
    const auto light = [](uint8_t colour) { return linear(colour / 255.0) + kLost; };
    size_t compared = 0;
    for (size_t i = 0; i < once.rgba.size(); i += 4) {
        const auto [low, high] = std::minmax({light(once.rgba[i]), light(once.rgba[i + 1]), light(once.rgba[i + 2])});
        if (low < 1.1 * kDark || 2 * high > 0.95 * kBright) continue;
        for (size_t c = i; c < i + 3; ++c)
            ASSERT_NEAR(twice.rgba[c], encoded(2 * light(once.rgba[c]) - kLost), 2) << "pixel " << i / 4;
        ++compared;
    }
    EXPECT_GT(compared, once.rgba.size() / 4 / 3) << "of all pixels";
    for (const Vec3<double>& point : {Vec3<double>{0, 0.5, 0}, {-0.9, 0, 0.5}})  // the square and the ground
        EXPECT_GT(sum_of(seen_at(twice, camera, point)), 1.2 * sum_of(seen_at(once, camera, point)));
}

TEST(DrawLight, FogGrowsWithDistance) {
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

}  // namespace
}  // namespace throng
