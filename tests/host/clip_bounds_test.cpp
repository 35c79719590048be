// Bounds of clips against the poses at every row and halfway between rows, for all joints, by the corners of the boxes
// that they move.
#include "reference/influence_boxes.h"
#include "reference/sampled_poses.h"
#include "sample/sample_reference.h"
#include "tests/test_rig.h"

#include <gtest/gtest.h>

#include <string>

namespace throng::test {
namespace {

Box bounds_of_poses(const Character& character, uint32_t clip) {
    const std::vector<Box> boxes = influence_boxes(character);
    Box bounds;
    const auto add_pose = [&](double time_s) {
        const std::vector<AffineT<double>> model_from_joint = model_from_joint_of(character, {clip, time_s});
        for (size_t joint = 0; joint < boxes.size(); ++joint)
            for (size_t corner = 0; corner < 8; ++corner)
                bounds.add(transform_point(model_from_joint[joint], boxes[joint].corner(corner)));
    };
    const std::span<const float> times_s = row_times(character, clip);
    for (size_t row = 0; row < times_s.size(); ++row) {
        add_pose(times_s[row]);
        if (row + 1 < times_s.size()) add_pose((double{times_s[row]} + times_s[row + 1]) / 2);
    }
    return bounds;
}

void expect_bounds(const Character& character) {
    for (uint32_t clip = 0; clip < character.clips.size(); ++clip) {
        const Box wanted = bounds_of_poses(character, clip);
        const Vec3<float> min = character.clips[clip].bounds_min, max = character.clips[clip].bounds_max,
                          low = wanted.low.as<float>(), high = wanted.high.as<float>();
        for (const auto axis : {&Vec3<float>::x, &Vec3<float>::y, &Vec3<float>::z}) {
            EXPECT_FLOAT_EQ(min.*axis, low.*axis) << character.clips[clip].name;
            EXPECT_FLOAT_EQ(max.*axis, high.*axis) << character.clips[clip].name;
        }
    }
}

TEST(ClipBounds, ContainEveryPose) {
    for (const RigShape shape : kRigShapes) expect_bounds(make_character({.joint_count = 40, .shape = shape}));
}

// Games hide parts that a clip does not need by shrinking them to nothing, often far away.
TEST(ClipBounds, LeaveOutPartsScaledToZero) {
    Asset asset = make_asset({.joint_count = 12, .shape = RigShape::kChain, .clip_count = 0});
    const auto hide = [](uint32_t node, double scale) {
        AssetClip clip{.name = "hide " + std::to_string(node), .duration_s = 1, .tracks = {}};
        clip.tracks.push_back(
            {.node = node, .target = TrackTarget::kTranslation, .times_s = {0}, .values = {0, -30000, 0}});
        const auto s = static_cast<float>(scale);
        clip.tracks.push_back({.node = node, .target = TrackTarget::kScale, .times_s = {0}, .values = {s, s, s}});
        return clip;
    };
    asset.clips = {hide(11, 0), hide(11, 0.01), hide(0, 0)};
    for (AssetMesh& mesh : asset.meshes)
        for (AssetPrimitive& primitive : mesh.primitives)
            for (size_t i = 0; i < primitive.influence_weights.size(); ++i)
                primitive.influence_weights[i] = i % primitive.influence_count == 0 ? 1 : 0;
    Character character = compiled(asset);
    ASSERT_TRUE(joints_that_move_alone(character)[11]);
    const auto extent = [&](size_t clip) {
        return length(character.clips[clip].bounds_max - character.clips[clip].bounds_min);
    };
    EXPECT_GT(extent(0), 0);
    EXPECT_LT(extent(0), 10 * character.size);
    EXPECT_GT(extent(1), 20000) << "small, but there";
    EXPECT_EQ(extent(2), 0) << "all is hidden";
    // A joint that shares vertices with another one stretches them, however small its scale is.
    for (Influences& influences : character.influences)
        influences = {.weights = {0.5f, 0.5f, 0, 0},
                      .entries = {0, static_cast<uint16_t>(character.palette.size() - 1)}};
    ASSERT_FALSE(joints_that_move_alone(character)[character.palette.back().joint]);
}

// Parts that stand still are the extreme on one side, and parts carried along by a moving parent on the other.
TEST(ClipBounds, ContainStillAndCarriedParts) {
    Asset asset = make_asset({.joint_count = 12, .shape = RigShape::kChain, .clip_count = 0});
    for (const uint32_t node : {0u, 6u, 11u})
        asset.clips.push_back({.name = "node " + std::to_string(node),
                               .duration_s = 1,
                               .tracks = {{.node = node,
                                           .target = TrackTarget::kTranslation,
                                           .times_s = {0, 1},
                                           .values = {0, 0, 0, 100, -200, 300}}}});
    expect_bounds(compiled(asset));
}

// A triangle on the first node, a clip for that node, and a socket on it that clips can show.
Asset triangle_with_a_socket() {
    Asset asset{.name = "triangle"};
    asset.nodes = {{.name = "body"}, {.name = "socket", .parent = 0}, {.name = "tip", .parent = 1}};
    asset.nodes[1].parent_from_node.scale = {1e-4f, 1e-4f, 1e-4f};
    asset.skins = {{.name = "skin", .joints = {0, 1, 2}, .inverse_binds = {{}, {}, {}}}};
    asset.meshes = {{.name = "mesh", .primitives = {{.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}}}};
    AssetPrimitive& triangle = asset.meshes[0].primitives[0];
    triangle.influence_count = 4;
    triangle.influence_joints.assign(12, 0);
    triangle.influence_weights = {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0};
    triangle.indices = {0, 1, 2};
    asset.mesh_instances = {{.node = 0, .mesh = 0, .skin = 0}};
    return asset;
}

// Artists hide things this way. A sword may be attached there, but nothing 100 times the character's size.
TEST(ClipBounds, ASocketThatIsTinyAtRestDoesNotEnlargeThem) {
    Asset asset = triangle_with_a_socket();
    asset.clips = {
        {.name = "show",
         .duration_s = 1,
         .tracks = {{.node = 1, .target = TrackTarget::kScale, .times_s = {0, 1}, .values = {0, 0, 0, 1, 1, 1}}}}};
    const Character character = compiled(asset);
    ASSERT_EQ(character.rig.joint_count(), 3u);
    const Vec3<float> extent = character.clips[0].bounds_max - character.clips[0].bounds_min;
    EXPECT_LT(length(extent), 1.1f * character.size);
    EXPECT_GT(extent.z, 0.02f * character.size) << "the socket's cube, where the mesh is flat";
}

TEST(ClipBounds, ContainAllMorphWeightsOfClips) {
    Asset asset = triangle_with_a_socket();
    AssetMesh& mesh = asset.meshes[0];
    mesh.weights.assign(4, 0);
    mesh.primitives[0].targets.assign(4, {.positions = std::vector<Vec3<float>>(3, {1, 0, 0})});
    const auto add_clip = [&](const std::vector<float>& times_s, const std::vector<float>& weights) {
        asset.clips.push_back(
            {.name = "clip", .duration_s = 1, .morph_tracks = {{.node = 0, .times_s = times_s, .values = weights}}});
    };
    add_clip({0, 1}, {0, 0, 0, 0, 1, 1, 1, 1});
    add_clip({0}, {0, 3, 0, 0});
    add_clip({0}, {0, 0, -2, 0});
    for (const Clip& clip : compiled(asset).clips) {
        EXPECT_EQ(clip.bounds_max.x, 1 + (1 + 3 + 1 + 1)) << "the largest of all clips at once";
        EXPECT_EQ(clip.bounds_min.x, -2);
    }
}

}  // namespace
}  // namespace throng::test
