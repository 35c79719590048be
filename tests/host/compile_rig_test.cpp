// How compilation turns nodes, meshes and skins into rigs, sections and palettes.
#include "compile/rig/rig.h"
#include "tests/host/compile_cases.h"
#include "tests/shared.h"
#include "tests/test_rig.h"
#include "tests/text.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

namespace throng {
namespace {

using namespace test;

Trs<double> similarity(Random& random) {
    Trs<double> trs = random.trs(0.3, 0);
    const double scale = random.between(0.8, 1.25);
    trs.scale = {scale, scale, scale};
    return trs;
}

// Random trees in which some nodes are skinned, some animated, and the rest only stand between.
TEST(Compile, FoldingStaticNodesChangesNothing) {
    size_t folded = 0, kept_static = 0;
    double worst = 0;
    for (uint64_t seed = 10; seed < 20; ++seed) {
        Random random(seed);
        AssetBuilder builder;
        std::vector<uint32_t> skinned, animated;
        for (uint32_t i = 0; i < 80; ++i) {
            const uint32_t parent = i == 0 || random.chance(0.05) ? kNone : i - 1 - random.below(std::min(i, 5u));
            Trs<double> trs = i % 7 == 3            ? Trs<double>{}
                              : random.chance(0.15) ? random.trs(0.3, 0.2)
                                                    : similarity(random);
            if (random.chance(0.05)) trs.scale = trs.scale * -1.0;
            builder.node(parent, trs);
            if (random.chance(0.2))
                skinned.push_back(i);
            else if (random.chance(0.2))
                animated.push_back(i);
        }
        if (skinned.empty()) skinned.push_back(79);
        builder.mesh(0, builder.skin(skinned));
        builder.mesh(60);
        for (const uint32_t node : animated) {
            const Quaternion<double> a = random.rotation(), b = random.rotation();
            const auto f = [](double x) { return static_cast<float>(x); };
            builder.track(node, TrackTarget::kRotation, {0, 1},
                          {f(a.x), f(a.y), f(a.z), f(a.w), f(b.x), f(b.y), f(b.z), f(b.w)});
            builder.track(node, TrackTarget::kTranslation, {0, 0.4f, 1}, {0, 0, 0, 0.2f, 0.1f, 0, 0.1f, 0.3f, 0.2f});
            builder.track(node, TrackTarget::kScale, {0, 1}, {1, 1, 1, 1.2f, 0.9f, 1.1f}, Interpolation::kStep);
        }
        const Character character = compiled(builder.asset);
        folded += build_rig(builder.asset).folded_node_count;
        for (uint32_t joint = 0; joint < character.rig.joint_count(); ++joint) {
            const uint32_t node = character.rig.nodes[joint], parent = character.rig.parents[joint];
            EXPECT_TRUE(parent == kNone || parent < joint);
            EXPECT_EQ(character.rig.names[joint], builder.asset.nodes[node].name);
            kept_static += std::count(skinned.begin(), skinned.end(), node) == 0 &&
                           std::count(animated.begin(), animated.end(), node) == 0;
        }
        for (const double time_s : {0.0, 0.25, 0.4, 0.77, 1.0}) {
            const AssetClip* clip = builder.asset.clips.empty() ? nullptr : &builder.asset.clips[0];
            const std::vector<AffineT<double>> models = node_models(builder.asset, clip, time_s);
            const ReferencePose pose = *reference_pose(
                character, {.first = {.clip = clip ? 0 : kNone, .time_s = time_s, .loop = false}});
            for (uint32_t joint = 0; joint < character.rig.joint_count(); ++joint) {
                const double error = matrix_error(pose.model_from_joint[joint].as<float>(),
                                                  models[character.rig.nodes[joint]], 1);
                EXPECT_LE(error, 3e-6) << "seed " << seed << ", node " << character.rig.nodes[joint] << " at "
                                       << time_s;
                worst = std::max(worst, error);
            }
            // The rigid mesh as well, whatever its parent node is.
            const MeshSection& rigid = character.sections[1];
            const uint32_t entry = character.influences[rigid.first_influences].entries[0];
            EXPECT_LE(matrix_error(pose.model_from_bind[entry].as<float>(), models[60], 1), 3e-6) << "seed " << seed;
        }
    }
    EXPECT_GT(folded, 50u);
    EXPECT_GT(kept_static, 10u) << "static, but scaled unevenly";
    std::printf("  10 trees of 80 nodes: %zu nodes folded, %zu kept for their scale; largest error %.1e\n", folded,
                kept_static, worst);
}

TEST(Compile, AnUnevenlyScaledNodeIsKept) {
    for (const Vec3<double>& scale :
         {Vec3<double>{2, 1, 1}, Vec3<double>{1, 2, 1}, Vec3<double>{1, 1, 2}, Vec3<double>{1, 1, 1}}) {
        AssetBuilder builder;
        Trs<double> middle;
        middle.scale = scale;
        const uint32_t root = builder.node(kNone), joint = builder.node(builder.node(root, middle));
        builder.mesh(root, builder.skin({joint}));
        EXPECT_EQ(compiled(builder.asset).rig.joint_count(), scale.x == scale.y && scale.y == scale.z ? 1u : 2u);
    }
    AssetBuilder builder;
    Trs<double> even = moved(1, 0, 0), uneven = moved(0, 1, 0);
    even.scale = {2, 2, 2};
    uneven.scale = {1, 2, 1};
    const uint32_t root = builder.node(kNone, even), middle = builder.node(root, uneven),
                   joint = builder.node(middle, moved(0, 0, 1));
    builder.mesh(root, builder.skin({joint}));
    const Character character = compiled(builder.asset);
    ASSERT_EQ(character.rig.joint_count(), 2u);
    EXPECT_EQ(character.rig.nodes, (std::vector<uint32_t>{middle, joint}));
    EXPECT_EQ(character.rig.rest[0].scale, (Vec3<float>{2, 4, 2}));
    EXPECT_EQ(character.rig.rest[0].translation, (Vec3<float>{1, 2, 0}));
}

TEST(Compile, RigOrderAndStatisticsAreComputed) {
    AssetBuilder builder;
    const uint32_t a = builder.node(kNone), b = builder.node(a), c = builder.node(b), d = builder.node(a),
                   e = builder.node(kNone);
    builder.mesh(a, builder.skin({e, d, c, b, a}));
    const Character character = compiled(builder.asset);
    EXPECT_EQ(character.rig.nodes, (std::vector<uint32_t>{a, b, c, d, e})) << "depth first";
    EXPECT_EQ(character.rig.parents, (std::vector<uint32_t>{kNone, 0, 1, 0, kNone}));
    EXPECT_EQ(character.rig.level_count, 3u);
    EXPECT_EQ(character.rig.leaf_count, 3u);
    EXPECT_DOUBLE_EQ(character.rig.mean_depth, (1 + 2 + 3 + 2 + 1) / 5.0);
    std::vector<uint32_t> joints;
    for (const PaletteEntry& entry : character.palette) joints.push_back(entry.joint);
    EXPECT_EQ(joints, (std::vector<uint32_t>{4, 3, 2, 1, 0})) << "the palette keeps the file's order";
}

// More joints than a workgroup has invocations, and parents that come after their children in the file.
TEST(Compile, LargeRigsInAnyOrder) {
    constexpr uint32_t kCount = 3000;
    AssetBuilder builder;
    std::vector<uint32_t> joints;
    for (uint32_t i = 0; i < kCount; ++i)
        joints.push_back(
            builder.node(i + 1 == kCount ? kNone : i + 1 + (i % 2 == 0 && i + 2 < kCount ? 1 : 0), moved(0.001, 0, 0)));
    builder.mesh(0, builder.skin(joints));
    const Character character = compiled(builder.asset);
    ASSERT_EQ(character.rig.joint_count(), kCount);
    EXPECT_EQ(character.rig.nodes[0], kCount - 1);
    for (uint32_t joint = 1; joint < kCount; ++joint) {
        ASSERT_LT(character.rig.parents[joint], joint);
        ASSERT_EQ(character.rig.nodes[character.rig.parents[joint]],
                  builder.asset.nodes[character.rig.nodes[joint]].parent);
    }
}

TEST(Compile, LimitsAreNamed) {
    AssetBuilder builder;
    std::vector<uint32_t> joints;
    for (uint32_t i = 0; i < 65'536; ++i) joints.push_back(builder.node(i == 0 ? kNone : 0));
    builder.mesh(0, builder.skin(joints));
    const Error error = refusal_of(builder.asset);
    EXPECT_EQ(error.code, ErrorCode::kLimit);
    EXPECT_TRUE(contains(error.text(), "65535") && contains(error.text(), "built")) << error.text();
    joints.pop_back();
    builder.asset.skins[0] = {.name = "skin", .joints = joints, .inverse_binds = std::vector<Affine>(joints.size())};
    EXPECT_EQ(compiled(builder.asset).rig.joint_count(), 65'535u);
    // Two different skins with as many joints: more palette entries than 16 bits can address.
    builder.skin(joints);
    builder.asset.skins[1].inverse_binds[5].row[0][3] = 1;
    const Error palette = refusal_of(builder.asset);
    EXPECT_EQ(palette.code, ErrorCode::kLimit);
    EXPECT_TRUE(contains(palette.text(), "65536")) << palette.text();
}

// A file of a few kilobytes can contain this.
TEST(Compile, AMeshCountsForEachNodeThatShowsIt) {
    AssetBuilder builder;
    builder.mesh(builder.node(kNone));
    AssetPrimitive& primitive = builder.asset.meshes[0].primitives[0];
    primitive.positions.resize(4096);
    builder.asset.mesh_instances.resize(10'000, builder.asset.mesh_instances[0]);
    const Error error = refusal_of(builder.asset);
    EXPECT_EQ(error.code, ErrorCode::kLimit);
    EXPECT_TRUE(contains(error.text(), "built: its meshes take ") && contains(error.text(), "the limit is 2048 MiB"))
        << error.text();
}

TEST(Compile, SectionsAndTheirNamesAreLimited) {
    AssetBuilder builder;
    builder.mesh(builder.node(kNone));
    std::vector<AssetPrimitive>& primitives = builder.asset.meshes[0].primitives;
    primitives.resize(600, primitives[0]);
    builder.asset.mesh_instances.resize(600, builder.asset.mesh_instances[0]);
    const Error sections = refusal_of(builder.asset);
    EXPECT_EQ(sections.code, ErrorCode::kLimit);
    EXPECT_TRUE(contains(sections.text(), "built: its meshes have 360000 primitives, each counted for every node") &&
                contains(sections.text(), "the limit is 262144"))
        << sections.text();
    builder.asset.mesh_instances.resize(1);
    builder.asset.nodes[0].name.assign(size_t{4} << 20, 'n');
    EXPECT_TRUE(contains(refusal_of(builder.asset).text(), "its meshes take 2400 MiB"));
}

// Points, lines and primitives without positions: a file of a few kilobytes can have 20,000 of them at 20,000 nodes.
TEST(Compile, PrimitivesWithoutTrianglesHaveNoSection) {
    AssetBuilder builder;
    builder.mesh(builder.node(kNone));
    std::vector<AssetPrimitive>& primitives = builder.asset.meshes[0].primitives;
    const AssetPrimitive triangle = primitives[0];
    primitives = {{}, {.positions = triangle.positions}, triangle};
    primitives.resize(20'000);
    builder.asset.mesh_instances.resize(20'000, builder.asset.mesh_instances[0]);
    const Character character = compiled(builder.asset, {.error = 0, .lods = false});
    ASSERT_EQ(character.sections.size(), 20'000u);
    EXPECT_EQ(character.vertices.size(), 60'000u);
    for (const MeshSection& section : character.sections) ASSERT_EQ(section.primitive, 2u);
}

// Each case has four million instances times as many nodes, or as many influences.
TEST(Compile, ManyInstancesCompileQuickly) {
    constexpr uint32_t kInstances = kSanitized ? 200'000 : 4'000'000, kNodes = kSanitized ? 1'000 : 400'000;
    AssetBuilder chain;
    for (uint32_t i = 0; i < kNodes; ++i)
        chain.asset.nodes.push_back({.parent = i == 0 ? kNone : i - 1, .parent_from_node = moved(0.25, 0, 0)});
    chain.mesh(kNodes - 1);
    chain.asset.meshes.emplace_back();  // draws nothing
    chain.asset.mesh_instances.resize(kInstances, {.node = kNodes - 1, .mesh = 1});
    const Character character = compiled(chain.asset, {.error = 0, .lods = false});
    EXPECT_EQ(character.rig.joint_count(), 1u);
    ASSERT_EQ(character.palette.size(), 1u);
    EXPECT_EQ(character.palette[0].joint_from_bind.row[0][3], 0.25f * (kNodes - 1));

    AssetBuilder skinned;
    const uint32_t joint = skinned.node(kNone);
    skinned.mesh(joint, skinned.skin({joint}));
    AssetPrimitive& primitive = skinned.asset.meshes[0].primitives[0];
    primitive.positions.resize(kNodes);
    primitive.influence_joints.resize(4 * size_t{kNodes});
    primitive.influence_weights.resize(4 * size_t{kNodes}, 0.25f);
    skinned.asset.mesh_instances.resize(kInstances, skinned.asset.mesh_instances[0]);
    EXPECT_EQ(refusal_of(skinned.asset).code, ErrorCode::kLimit);
    primitive.influence_joints.back() = 1;
    EXPECT_TRUE(contains(refusal_of(skinned.asset).text(), "mesh_instances[0]: a joint with weight is 1"));
}

TEST(Compile, AnAssetWithNothingToDrawIsRefused) {
    AssetBuilder builder;
    builder.node(kNone);
    const Error error = refusal_of(builder.asset);
    EXPECT_EQ(error.code, ErrorCode::kUnsupported);
    EXPECT_TRUE(contains(error.text(), "no skin and no triangles: there is nothing to draw")) << error.text();
    EXPECT_FALSE(contains(error.text(), "animation")) << error.text();
    builder.asset.clips.emplace_back();
    EXPECT_TRUE(contains(refusal_of(builder.asset).text(), "only animation"));
    EXPECT_EQ(refusal_of({}).code, ErrorCode::kUnsupported);
}

TEST(Compile, KeysThatExceedAllFloatsAreRefused) {
    AssetBuilder builder;
    const uint32_t large = builder.node(kNone, {.scale = {1e3, 1e3, 1e3}}), child = builder.node(large);
    builder.mesh(child);
    builder.asset.clips = {{.name = "leap", .duration_s = 1}};
    AssetTrack track{.node = child, .target = TrackTarget::kTranslation, .times_s = {0, 1}};
    for (const float at : {0.0f, 1e37f}) {
        track.values = {0, 0, 0, at, 0, 0};
        builder.asset.clips[0].tracks = {track};
        const Result<Character> character = compile_character(builder.asset);
        ASSERT_EQ(character.ok(), at == 0);
        if (character) continue;
        const std::string text = character.error().text();
        EXPECT_TRUE(contains(text, "animations[0]: the track of node 1 exceeds all floats at 1.000000 s")) << text;
    }
}

// Meshes of only points or lines have no indices, and need no joint.
TEST(Compile, NodesThatAreNotDrawnNeedNoJoint) {
    AssetBuilder lines;
    lines.asset.meshes[lines.mesh(lines.node(kNone))].primitives[0].indices.clear();
    EXPECT_TRUE(contains(refusal_of(lines.asset).text(), "no triangles: there is nothing to draw"));

    AssetBuilder avatar;
    const uint32_t joint = avatar.node(kNone), beside = avatar.node(kNone);
    avatar.asset.meshes[avatar.mesh(beside)].primitives[0].indices.clear();
    AssetMesh& skinned = avatar.asset.meshes[avatar.mesh(beside, avatar.skin({joint}))];
    skinned.primitives.push_back(avatar.asset.meshes[0].primitives[0]);
    EXPECT_EQ(compiled(avatar.asset).rig.nodes, std::vector<uint32_t>{joint});
    skinned.primitives[1].indices = {0, 1, 2};
    EXPECT_EQ(compiled(avatar.asset).rig.nodes, (std::vector<uint32_t>{joint, beside})) << "where it is drawn";
}

TEST(Compile, ASkinWithoutAMeshIsEnough) {
    AssetBuilder builder;
    const uint32_t a = builder.node(kNone), b = builder.node(a, moved(0, 3, 4));
    builder.skin({a, b});
    const Character character = compiled(builder.asset);
    EXPECT_EQ(character.palette.size(), 2u);
    EXPECT_TRUE(character.vertices.empty());
    EXPECT_FLOAT_EQ(character.size, 5) << "of the joints, where there is no mesh";
}

// ---- Meshes and skins

TEST(Compile, EqualSkinsShareTheirPalette) {
    AssetBuilder builder;
    const uint32_t a = builder.node(kNone), b = builder.node(a), c = builder.node(a);
    builder.skin({a, b});
    builder.skin({b, c});
    builder.skin({a, b});
    builder.skin({a, b});
    builder.asset.skins[3].inverse_binds[1].row[1][3] = 2;
    for (uint32_t skin = 0; skin < 4; ++skin) builder.mesh(a, skin);
    const Character character = compiled(builder.asset);
    EXPECT_EQ(character.palette.size(), 6u) << "two each of three different skins";
    ASSERT_EQ(character.skins.size(), 4u);
    EXPECT_EQ(character.skins[2].first_entry, character.skins[0].first_entry);
    EXPECT_NE(character.skins[3].first_entry, character.skins[0].first_entry);
    for (uint32_t s = 0; s < 4; ++s) {
        EXPECT_EQ(character.skins[s].joint_count, 2u);
        const MeshSection& section = character.sections[s];
        EXPECT_EQ(section.skin, s);
        for (uint32_t v = 0; v < 3; ++v) {
            const uint32_t entry = character.influences[section.first_influences + v].entries[0];
            const uint32_t node = character.rig.nodes[character.palette[entry].joint];
            EXPECT_EQ(node, builder.asset.skins[s].joints[v % 2]);
        }
    }
}

TEST(Compile, ARigidMeshFollowsItsNode) {
    AssetBuilder builder;
    const uint32_t joint = builder.node(kNone, moved(1, 0, 0));
    const uint32_t hand = builder.node(joint, moved(0, 2, 0)), sword = builder.node(hand, moved(0, 0, 3));
    builder.skin({joint});
    builder.mesh(sword);
    builder.track(joint, TrackTarget::kTranslation, {0, 1}, {1, 0, 0, 5, 0, 0});
    const Character character = compiled(builder.asset);
    EXPECT_EQ(character.rig.joint_count(), 1u) << "hand and sword stand still";
    ASSERT_EQ(character.palette.size(), 2u);
    EXPECT_EQ(character.sections[0].skin, kNone);
    EXPECT_EQ(character.sections[0].node, sword);
    const ReferencePose pose = *reference_pose(character, {.first = {.clip = 0, .time_s = 1, .loop = false}});
    EXPECT_EQ(reference_positions(character, pose)[1], (Vec3<double>{5 + 1, 2, 3}));
    EXPECT_EQ(character.bounds_min, (Vec3<float>{1, 2, 3}));
    EXPECT_EQ(character.bounds_max, (Vec3<float>{2, 3, 3}));
}

TEST(Compile, AnAnimatedNodeThatCarriesAMeshIsAJoint) {
    AssetBuilder builder;
    const uint32_t wheel = builder.node(builder.node(kNone, moved(0, 0, 5)));
    builder.mesh(wheel);
    builder.track(wheel, TrackTarget::kRotation, {0, 1}, {0, 0, 0, 1, 0, 0, 1, 0});
    const Character character = compiled(builder.asset);
    EXPECT_EQ(character.rig.nodes, (std::vector<uint32_t>{wheel}));
    const ReferencePose pose = *reference_pose(character, {.first = {.clip = 0, .time_s = 0.5}});
    const Vec3<double> corner = reference_positions(character, pose)[1];
    EXPECT_LE(length(corner - Vec3<double>{0, 1, 5}), 1e-6) << "a quarter turn about z";
}

TEST(Compile, AMirroringNodeFlipsTheWinding) {
    AssetBuilder builder;
    Trs<double> mirror;
    mirror.scale = {-1, 1, 1};
    builder.mesh(builder.node(kNone, mirror));
    builder.mesh(builder.node(kNone));
    const Character character = compiled(builder.asset);
    EXPECT_EQ(character.indices, (std::vector<uint32_t>{0, 2, 1, 0, 1, 2}));
}

// The specification uses the node's transform for the winding order, though a skinned mesh otherwise ignores it.
TEST(Compile, AMirroringNodeFlipsTheWindingOfSkins) {
    AssetBuilder builder;
    Trs<double> mirror;
    mirror.scale = {1, 1, -1};
    const uint32_t armature = builder.node(kNone, mirror), body = builder.node(armature),
                   joint = builder.node(armature), twice = builder.node(armature, mirror), beside = builder.node(kNone);
    const uint32_t skin = builder.skin({joint});
    for (const uint32_t node : {armature, body, twice, beside}) builder.mesh(node, skin);
    const Character character = compiled(builder.asset);
    ASSERT_EQ(character.sections.size(), 4u);
    EXPECT_EQ(character.indices, (std::vector<uint32_t>{0, 2, 1, 0, 2, 1, 0, 1, 2, 0, 1, 2}));
}

TEST(Compile, WeightsAreNormalized) {
    AssetBuilder builder;
    const uint32_t a = builder.node(kNone), b = builder.node(a), c = builder.node(a);
    builder.mesh(a, builder.skin({a, b, c}), 8);
    AssetPrimitive& primitive = builder.asset.meshes[0].primitives[0];
    primitive.influence_weights = {1, 2, 1, 0, 0, 3, 0, 1, 0.5f, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0};
    const Character character = compiled(builder.asset);
    EXPECT_EQ(character.sections[0].influence_sets, 2u);
    ASSERT_EQ(character.influences.size(), 6u);
    EXPECT_EQ(character.influences[0].weights, (std::array<float, 4>{0.125f, 0.25f, 0.125f, 0}));
    EXPECT_EQ(character.influences[1].weights, (std::array<float, 4>{0, 0.375f, 0, 0.125f}));
    EXPECT_EQ(character.influences[1].entries, (std::array<uint16_t, 4>{1, 2, 0, 1}));
    EXPECT_EQ(character.influences[2].weights, (std::array<float, 4>{1, 0, 0, 0}));
    EXPECT_EQ(character.influences[4].weights, (std::array<float, 4>{1, 0, 0, 0}))
        << "without a weight: the first joint";
    EXPECT_EQ(character.influences[4].entries[0], 2u);
    ASSERT_EQ(character.warnings.size(), 1u);
    EXPECT_EQ(character.warnings[0],
              "built: meshes[0].primitives[0]: 1 of 3 skinned vertices, the first of them here, have no weight: "
              "they follow their first joint (JOINTS_0)");
}

TEST(Compile, ManyVerticesWithoutWeightAreOneWarning) {
    AssetBuilder builder;
    const uint32_t a = builder.node(kNone), b = builder.node(a);
    const uint32_t skin = builder.skin({a, b});
    for (int i = 0; i < 5; ++i) builder.mesh(a, skin);
    for (size_t i = 1; i < 5; ++i) {
        AssetPrimitive& primitive = builder.asset.meshes[i].primitives[0];
        primitive.influence_weights.assign(12, 0.0f);
        primitive.influence_joints[0] = 7;  // of a larger skin
    }
    const Character character = compiled(builder.asset);
    ASSERT_EQ(character.warnings.size(), 1u);
    const std::string& warning = character.warnings[0];
    EXPECT_TRUE(contains(warning, "meshes[1].primitives[0]: 12 of 15 skinned vertices")) << warning;
    EXPECT_EQ(character.influences[3].entries[0], character.skins[0].first_entry) << "the skin's first joint";
    EXPECT_EQ(character.influences[4].entries[0], character.skins[0].first_entry + 1);
}

// A skinned and an unskinned primitive in one mesh with a skin.
TEST(Compile, PrimitivesWithoutJointsFollowTheirNode) {
    AssetBuilder builder;
    const uint32_t root = builder.node(kNone, moved(0, 0, 2)), joint = builder.node(root, moved(3, 0, 0));
    builder.mesh(root, builder.skin({joint}));
    builder.asset.meshes[0].primitives.push_back(
        {.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, .indices = {0, 1, 2}});
    const Character character = compiled(builder.asset);
    ASSERT_EQ(character.sections.size(), 2u);
    EXPECT_EQ(character.sections[0].skin, 0u);
    EXPECT_EQ(character.sections[1].skin, kNone);
    EXPECT_EQ(character.sections[1].first_vertex, 3u);
    const std::vector<Vec3<double>> positions = reference_positions(character, *reference_pose(character, {}));
    EXPECT_EQ(positions[0], (Vec3<double>{3, 0, 2}));
    EXPECT_EQ(positions[3], (Vec3<double>{0, 0, 2}));
}

TEST(Compile, ARestPoseThatIsNotFiniteIsRefused) {
    AssetBuilder builder;
    builder.mesh(builder.node(kNone, moved(1e300, 0, 0)));
    EXPECT_EQ(refusal_of(builder.asset).code, ErrorCode::kInvalidFile);
}

}  // namespace
}  // namespace throng
