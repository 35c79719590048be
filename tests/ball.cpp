#include "tests/ball.h"

#include "tests/files.h"

#include <algorithm>
#include <array>
#include <numbers>

namespace throng::test {

std::vector<std::byte> png_bytes(const Picture& picture) {
    const TemporaryFolder folder;
    if (!write_png(folder.path() / "picture.png", picture)) return {};
    const std::string text = read_file(folder.path() / "picture.png");
    const auto* const bytes = reinterpret_cast<const std::byte*>(text.data());
    return {bytes, bytes + text.size()};
}

Picture gradient(uint32_t width, uint32_t height) {
    Picture picture{width, height, {}};
    for (uint32_t i = 0; i < width * height * 4; ++i) picture.rgba.push_back(static_cast<uint8_t>(i * 37 + i / 11));
    return picture;
}

Asset make_ball(const BallSettings& settings) {
    Asset asset{.name = "ball"};
    asset.nodes = {{.name = "bottom"},
                   {.name = "top", .parent = 0, .parent_from_node = {.translation = {0, settings.radius, 0}}},
                   {.name = "mesh"}};
    Affine top_from_model;
    top_from_model.row[1][3] = -static_cast<float>(settings.radius);
    asset.skins = {{.name = "skin", .joints = {0, 1}, .inverse_binds = {Affine{}, top_from_model}}};
    AssetPrimitive primitive{.material = 0, .influence_count = settings.influence_count};
    AssetMorphTarget swells, turns;
    for (uint32_t row = 0; row <= settings.rows; ++row)
        for (uint32_t column = 0; column <= settings.columns; ++column) {
            const double across = static_cast<double>(column) / settings.columns,
                         down = static_cast<double>(row) / settings.rows;
            const double turn = across * (settings.is_open ? 1.5 : 2) * std::numbers::pi,
                         tilt = down * std::numbers::pi;
            const Vec3<double> normal{std::sin(turn) * std::sin(tilt), std::cos(tilt), std::cos(turn) * std::sin(tilt)};
            const Vec3<double> place = normal * settings.radius + Vec3<double>{0, settings.radius, 0};
            primitive.positions.push_back(place.as<float>());
            primitive.normals.push_back(normal.as<float>());
            primitive.texcoords.push_back({static_cast<float>(3 * across - 1), static_cast<float>(2 * down)});
            primitive.colors.push_back({1, static_cast<float>(1 - 0.5 * down), 1, 1});
            for (uint32_t i = 0; i < settings.influence_count; ++i) {
                primitive.influence_joints.push_back(i % 2);
                const double weight = i % 2 == 0 ? down : 1 - down;
                primitive.influence_weights.push_back(static_cast<float>(2 * weight / settings.influence_count));
            }
            const double far_out = std::max(normal.z, 0.0);
            swells.positions.push_back((normal * (0.4 * far_out * settings.radius)).as<float>());
            turns.normals.push_back((Vec3<double>{0.5, 0, 0} * far_out).as<float>());
        }
    const uint32_t pitch = settings.columns + 1;
    for (uint32_t row = 0; row < settings.rows; ++row)
        for (uint32_t column = 0; column < settings.columns; ++column) {
            const uint32_t first = row * pitch + column;
            if (row > 0) primitive.indices.insert(primitive.indices.end(), {first, first + pitch, first + 1});
            if (row + 1 < settings.rows)
                primitive.indices.insert(primitive.indices.end(), {first + 1, first + pitch, first + pitch + 1});
        }
    asset.clips = {{.name = "bends", .duration_s = 1}};
    const Quaternion<double> bent = axis_angle(Vec3<double>{0, 0, 1}, 0.7);
    asset.clips[0].tracks = {{.node = 1,
                              .target = TrackTarget::kRotation,
                              .times_s = {0, 1},
                              .values = {0, 0, 0, 1, static_cast<float>(bent.x), static_cast<float>(bent.y),
                                         static_cast<float>(bent.z), static_cast<float>(bent.w)}}};
    asset.meshes = {{.name = "ball"}};
    if (settings.has_morphs) {
        primitive.targets = {swells, turns};
        asset.meshes[0].weights = {0, 0};
        asset.clips[0].morph_tracks = {
            {.node = 2, .interpolation = Interpolation::kLinear, .times_s = {0, 1}, .values = {0, 0, 1, 1}}};
    }
    asset.meshes[0].primitives = {primitive};
    asset.mesh_instances = {{.node = 2, .mesh = 0, .skin = 0}};
    asset.materials = {{.name = "white", .metallic = 0, .roughness = 0.6f}};
    return asset;
}

void add_maps(Asset& asset) {
    const auto wave = [](double x) { return 0.5 + 0.5 * std::sin(x); };
    using Texel = std::array<double, 4>;
    asset.images = {make_image("colours", 96, 64,
                               [&](uint32_t x, uint32_t y) {
                                   const bool is_light = (x / 12 + y / 8) % 2 == 0;
                                   return Texel{is_light ? 0.9 : 0.2, 0.5 * wave(0.2 * x), is_light ? 0.3 : 0.7,
                                                wave(0.065 * x) * wave(0.1 * y)};
                               }),
                    make_image("metal", 33, 17,
                               [&](uint32_t x, uint32_t y) {
                                   return Texel{1, 0.2 + 0.8 * wave(0.5 * y), wave(0.3 * x), 1};
                               }),
                    make_image("normals", 50, 50,
                               [&](uint32_t x, uint32_t y) {
                                   return Texel{0.3 + 0.4 * wave(0.5 * x), 0.3 + 0.4 * wave(0.4 * y), 0.9, 1};
                               }),
                    make_image("occlusion", 16, 16,
                               [&](uint32_t x, uint32_t) {
                                   return Texel{wave(0.8 * x), 0, 0, 1};
                               }),
                    make_image("emission", 20, 12, [&](uint32_t x, uint32_t y) {
                        return Texel{x / 5 == y / 3 ? 0.8 : 0.0, 0.1, 0, 1};
                    })};
    AssetMaterial& material = asset.materials[0];
    material.image = 0, material.metallic_roughness_image = 1, material.normal_image = 2;
    material.occlusion_image = 3, material.emissive_image = 4;
    material.metallic = 1, material.roughness = 1, material.emissive = {1, 1, 1};
}

}  // namespace throng::test
