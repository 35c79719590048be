// Assets that an engine fills itself: each error is reported by name, and nothing crashes.
#include "tests/test_rig.h"
#include "tests/text.h"

#include <throng/character.h>

#include <gtest/gtest.h>

#include <functional>
#include <random>

namespace throng {
namespace {

using namespace test;

// An asset with a skin, a clip, a morph target and its keys, a material and an image.
Asset filled() {
    Asset asset{.name = "filled"};
    asset.nodes = {{.name = "body"}, {.name = "root"}, {.name = "tip", .parent = 1}};
    asset.nodes[2].parent_from_node.translation = {0, 1, 0};
    asset.skins = {{.name = "skin", .joints = {1, 2}, .inverse_binds = std::vector<Affine>(2)}};
    asset.images = {{.name = "image"}};
    asset.materials = {{.name = "cloth", .image = 0}};
    AssetPrimitive primitive{.material = 0,
                             .positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}},
                             .normals = std::vector<Vec3<float>>(3, {0, 0, 1}),
                             .texcoords = std::vector<std::array<float, 2>>(3),
                             .colors = std::vector<std::array<float, 4>>(3, {1, 1, 1, 1}),
                             .influence_count = 4,
                             .influence_joints = {0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0},
                             .influence_weights = {0.5f, 0.5f, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0},
                             .indices = {0, 1, 2}};
    primitive.targets = {{.positions = {{0, 0, 1}, {0, 0, 0}, {0, 0, 0}}, .normals = std::vector<Vec3<float>>(3)}};
    asset.meshes = {{.name = "mesh", .weights = {0.5f}, .target_names = {"smile"}, .primitives = {primitive}}};
    asset.mesh_instances = {{.node = 0, .mesh = 0, .skin = 0}};
    AssetClip clip{.name = "clip", .duration_s = 1};
    clip.tracks = {
        {.node = 2, .target = TrackTarget::kRotation, .times_s = {0, 1}, .values = {0, 0, 0, 1, 0, 0, 1, 0}}};
    clip.morph_tracks = {{.node = 0, .times_s = {0, 1}, .values = {0, 1}}};
    asset.clips = {clip};
    return asset;
}

TEST(AssetCheck, ErrorsNameWhatIsWrong) {
    ASSERT_TRUE(compile_character(filled()));
    struct Case {
        const char* message;
        std::function<void(Asset&)> spoil;
    };
    const auto primitive = [](Asset& asset) -> AssetPrimitive& { return asset.meshes[0].primitives[0]; };
    const auto track = [](Asset& asset) -> AssetTrack& { return asset.clips[0].tracks[0]; };
    const Case cases[]{
        {"nodes[2]: parent is 7, but there are 3 nodes", [&](Asset& a) { a.nodes[2].parent = 7; }},
        {"nodes[2] is an ancestor of itself", [&](Asset& a) { a.nodes[1].parent = 2; }},
        {"nodes[1] is an ancestor of itself", [&](Asset& a) { a.nodes[1].parent = 1; }},
        {"nodes[1]: parent_from_node", [&](Asset& a) { a.nodes[1].parent_from_node.scale.x = kNan; }},
        {"nodes[1]: the rotation",
         [&](Asset& a) {
             a.nodes[1].parent_from_node.rotation = {0, 0, 0, 0};
         }},
        {"skins[0]: a joint is 3", [&](Asset& a) { a.skins[0].joints[1] = 3; }},
        {"skins[0]: joints is empty", [&](Asset& a) { a.skins[0].joints.clear(); }},
        {"skins[0]: inverse_binds has 1 elements; 2", [&](Asset& a) { a.skins[0].inverse_binds.pop_back(); }},
        {"skins[0]: inverse_binds is not", [&](Asset& a) { a.skins[0].inverse_binds[0].row[1][2] = kNan; }},
        {"materials[0]: an image is 1", [&](Asset& a) { a.materials[0].emissive_image = 1; }},
        {"materials[0]: a factor", [&](Asset& a) { a.materials[0].roughness = kNan; }},
        {"materials[0]: alpha_mode, filter, wrap_u or wrap_v has",
         [&](Asset& a) { a.materials[0].alpha_mode = static_cast<AlphaMode>(3); }},
        {"materials[0]: alpha_mode, filter, wrap_u or wrap_v has",
         [&](Asset& a) { a.materials[0].filter = static_cast<TextureFilter>(2); }},
        {"materials[0]: alpha_mode, filter, wrap_u or wrap_v has",
         [&](Asset& a) { a.materials[0].wrap_v = static_cast<TextureWrap>(3); }},
        {"meshes[0]: weights", [&](Asset& a) { a.meshes[0].weights[0] = kNan; }},
        {"meshes[0]: target_names", [&](Asset& a) { a.meshes[0].target_names.push_back("blink"); }},
        {"meshes[0].primitives[0]: material is 1", [&](Asset& a) { primitive(a).material = 1; }},
        {"meshes[0].primitives[0]: positions", [&](Asset& a) { primitive(a).positions[2].y = kNan; }},
        {"meshes[0].primitives[0]: normals has 2", [&](Asset& a) { primitive(a).normals.pop_back(); }},
        {"meshes[0].primitives[0]: normals, texcoords or colors are not finite",
         [&](Asset& a) { primitive(a).normals[1].z = kNan; }},
        {"meshes[0].primitives[0]: normals, texcoords or colors are not finite",
         [&](Asset& a) { primitive(a).texcoords[2][0] = kNan; }},
        {"meshes[0].primitives[0]: normals, texcoords or colors are not finite",
         [&](Asset& a) { primitive(a).colors[0][3] = kNan; }},
        {"meshes[0].primitives[0]: texcoords has 2", [&](Asset& a) { primitive(a).texcoords.pop_back(); }},
        {"meshes[0].primitives[0]: colors has 4", [&](Asset& a) { primitive(a).colors.push_back({}); }},
        {"meshes[0].primitives[0]: influence_joints has 12", [&](Asset& a) { primitive(a).influence_count = 8; }},
        {"meshes[0].primitives[0]: influence_count is 6, not a multiple of 4",
         [&](Asset& a) {
             primitive(a).influence_count = 6;
             primitive(a).influence_joints.assign(18, 0);
             primitive(a).influence_weights.assign(18, 1.0f / 6);
         }},
        {"meshes[0].primitives[0]: influence_weights", [&](Asset& a) { primitive(a).influence_weights.pop_back(); }},
        {"meshes[0].primitives[0]: influence_weights must", [&](Asset& a) { primitive(a).influence_weights[0] = -1; }},
        {"meshes[0].primitives[0]: indices has 2", [&](Asset& a) { primitive(a).indices.pop_back(); }},
        {"meshes[0].primitives[0]: an index is 3", [&](Asset& a) { primitive(a).indices[1] = 3; }},
        {"meshes[0].primitives[0]: targets has 0 elements; 1 are needed, as many as the mesh's weights",
         [&](Asset& a) { primitive(a).targets.clear(); }},
        {"targets[0]: positions has 2", [&](Asset& a) { primitive(a).targets[0].positions.pop_back(); }},
        {"targets[0]: positions or normals are not", [&](Asset& a) { primitive(a).targets[0].normals[0].x = kNan; }},
        {"mesh_instances[0]: node is 3", [&](Asset& a) { a.mesh_instances[0].node = 3; }},
        {"mesh_instances[0]: mesh is 1", [&](Asset& a) { a.mesh_instances[0].mesh = 1; }},
        {"mesh_instances[0]: skin is 1", [&](Asset& a) { a.mesh_instances[0].skin = 1; }},
        {"mesh_instances[0]: weights has 2",
         [&](Asset& a) {
             a.mesh_instances[0].weights = {0, 1};
         }},
        {"mesh_instances[0]: a joint with weight is 2", [&](Asset& a) { primitive(a).influence_joints[4] = 2; }},
        {"mesh_instances must be ordered",
         [&](Asset& a) {
             a.mesh_instances = {{.node = 2}, {.node = 0}};
         }},
        {"clips[0]: duration_s", [&](Asset& a) { a.clips[0].duration_s = -1; }},
        {"clips[0]: duration_s", [&](Asset& a) { a.clips[0].duration_s = 1e39; }},
        {"clips[0].tracks[0]: target has", [&](Asset& a) { track(a).target = static_cast<TrackTarget>(255); }},
        {"clips[0].tracks[0]: interpolation has",
         [&](Asset& a) { track(a).interpolation = static_cast<Interpolation>(3); }},
        {"clips[0].morph_tracks[0]: interpolation has",
         [&](Asset& a) { a.clips[0].morph_tracks[0].interpolation = static_cast<Interpolation>(3); }},
        {"clips[0].morph_tracks[1]: an earlier track has the same node",
         [&](Asset& a) { a.clips[0].morph_tracks.push_back(a.clips[0].morph_tracks[0]); }},
        {"clips[0].tracks[0]: its last key, at 1.000000 s, is after the clip's duration_s of 0.500000 s",
         [&](Asset& a) { a.clips[0].duration_s = 0.5; }},
        {"clips[0].morph_tracks[0]: its last key", [&](Asset& a) { a.clips[0].morph_tracks[0].times_s.back() = 9; }},
        {"clips[0].tracks[0]: node is 3", [&](Asset& a) { track(a).node = 3; }},
        {"clips[0].tracks[1]: an earlier track", [&](Asset& a) { a.clips[0].tracks.push_back(track(a)); }},
        {"clips[0].tracks[0]: times_s must be finite", [&](Asset& a) { track(a).times_s.clear(); }},
        {"clips[0].tracks[0]: times_s must be finite", [&](Asset& a) { track(a).times_s[0] = -1; }},
        {"clips[0].tracks[0]: times_s must increase", [&](Asset& a) { track(a).times_s[0] = 1; }},
        {"clips[0].tracks[0]: values has 8 elements; 24",
         [&](Asset& a) { track(a).interpolation = Interpolation::kCubicSpline; }},
        {"clips[0].tracks[0]: values are not", [&](Asset& a) { track(a).values[3] = kNan; }},
        {"clips[0].morph_tracks[0]: values has 1", [&](Asset& a) { a.clips[0].morph_tracks[0].values.pop_back(); }},
        {"clips[0].morph_tracks[0]: node is 9", [&](Asset& a) { a.clips[0].morph_tracks[0].node = 9; }}};
    for (const auto& [message, spoil] : cases) {
        Asset asset = filled();
        spoil(asset);
        const Result<Character> character = compile_character(asset);
        ASSERT_FALSE(character) << message;
        EXPECT_EQ(character.error().code, ErrorCode::kInvalidArgument) << message;
        EXPECT_TRUE(contains(character.error().text(), message)) << message << " | " << character.error().text();
    }
}

// The name comes from the application.
TEST(AssetCheck, RefusalsAreOneLineWhateverTheName) {
    Asset asset = filled();
    asset.name = "two\nlines\x1b[2J";
    asset.nodes[2].parent = 7;
    const Result<Character> character = compile_character(asset);
    ASSERT_FALSE(character);
    EXPECT_EQ(character.error().text(), "two?lines?[2J: nodes[2]: parent is 7, but there are 3 nodes");
    asset.nodes[2].parent = 1;
    const Result<Character> cancelled = compile_character(asset, {}, {.is_cancelled = [] { return true; }});
    ASSERT_FALSE(cancelled);
    EXPECT_EQ(cancelled.error().text(), "two?lines?[2J: cancelled");
}

// Each scale is a float, their product is not. Other vertices are where they should be.
TEST(AssetCheck, ARestPoseThatOverflowsIsRefused) {
    Asset asset = filled();
    for (uint32_t node = 1; node <= 2; ++node) asset.nodes[node].parent_from_node.scale = {1e38f, 1e38f, 1e38f};
    for (uint32_t i = 0; i < 10; ++i) {
        asset.nodes.push_back({.name = "more", .parent = static_cast<uint32_t>(asset.nodes.size() - 1)});
        asset.nodes.back().parent_from_node.scale = {1e38f, 1e38f, 1e38f};
    }
    asset.skins[0].joints[1] = static_cast<uint32_t>(asset.nodes.size() - 1);
    const Result<Character> character = compile_character(asset);
    ASSERT_FALSE(character);
    EXPECT_EQ(character.error().text(), "filled: the rest pose is not finite");
}

// Keys are floats, and 0.1f is more than 0.1.
TEST(AssetCheck, AClipMayEndWithItsLastKey) {
    Asset asset = filled();
    asset.clips[0].duration_s = 0.1;
    asset.clips[0].tracks[0].times_s = asset.clips[0].morph_tracks[0].times_s = {0, 0.1f};
    EXPECT_TRUE(compile_character(asset));
}

// Randomly changes several numbers and lengths at a time. The asset compiles, or is refused in one line. Sanitizers
// check for memory errors.
TEST(AssetCheck, RandomlyDamagedAssetsDoNotCrash) {
    std::mt19937 random(7);
    const auto below = [&](size_t count) { return count == 0 ? 0 : random() % count; };
    const auto index = [&](uint32_t& of) { of = below(3) == 0 ? kNone : static_cast<uint32_t>(below(5)); };
    const auto number = [&](auto& of) {
        constexpr std::array<float, 6> kAny{0, -1, 1e30f, 3, kInfinity, 1e-30f};
        of = kAny[below(kAny.size())];
    };
    const auto length = [&](auto& items) { items.resize(below(items.size() + 2)); };
    size_t refused = 0;
    for (int round = 0; round < 3000; ++round) {
        Asset asset = filled();
        AssetPrimitive& p = asset.meshes[0].primitives[0];
        AssetClip& clip = asset.clips[0];
        const std::function<void()> changes[]{[&] { index(asset.nodes[below(3)].parent); },
                                              [&] { index(asset.skins[0].joints[below(2)]); },
                                              [&] { index(asset.mesh_instances[0].node); },
                                              [&] { index(asset.mesh_instances[0].mesh); },
                                              [&] { index(asset.mesh_instances[0].skin); },
                                              [&] { index(clip.tracks[0].node); },
                                              [&] { index(clip.morph_tracks[0].node); },
                                              [&] { index(p.material); },
                                              [&] { index(p.indices[below(3)]); },
                                              [&] { p.influence_joints[below(12)] = static_cast<uint16_t>(below(4)); },
                                              [&] { p.influence_count = static_cast<uint32_t>(below(3)) * 4; },
                                              [&] { number(asset.nodes[below(3)].parent_from_node.scale.x); },
                                              [&] { number(asset.nodes[below(3)].parent_from_node.translation.y); },
                                              [&] { number(p.positions[below(3)].x); },
                                              [&] { number(p.normals[below(3)].x); },
                                              [&] { number(p.influence_weights[below(12)]); },
                                              [&] { number(p.targets[0].positions[0].x); },
                                              [&] { number(clip.tracks[0].values[below(8)]); },
                                              [&] { number(clip.tracks[0].times_s[below(2)]); },
                                              [&] { number(clip.morph_tracks[0].values[below(2)]); },
                                              [&] { number(clip.duration_s); },
                                              [&] { length(asset.skins); },
                                              [&] { length(asset.mesh_instances); },
                                              [&] { length(asset.images); },
                                              [&] { length(asset.meshes[0].weights); }};
        for (size_t count = 1 + below(3); count > 0; --count) changes[below(std::size(changes))]();
        const Result<Character> character = compile_character(asset);
        if (character) continue;
        ++refused;
        EXPECT_EQ(character.error().text().find('\n'), std::string::npos);
    }
    EXPECT_GT(refused, 500u);
    EXPECT_LT(refused, 2900u);
}

}  // namespace
}  // namespace throng
