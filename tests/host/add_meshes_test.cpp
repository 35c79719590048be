// add_meshes(): meshes of another file on a rig with the same joint names.
#include "skin/skin_reference.h"
#include "tests/host/compile_cases.h"
#include "tests/test_rig.h"
#include "tests/text.h"

#include <throng/character.h>
#include <throng/reference.h>

#include <gtest/gtest.h>

#include <algorithm>

namespace throng {
namespace {

using namespace test;

// The same meshes in a file of their own: no clips, nodes in reverse order, names with a namespace, another rest pose.
Asset clothes_of(const Asset& asset) {
    const auto count = static_cast<uint32_t>(asset.nodes.size());
    const auto moved = [&](uint32_t node) { return node == kNone ? kNone : count - 1 - node; };
    Asset out = asset;
    out.name = "clothes.glb";
    out.clips.clear();
    std::ranges::reverse(out.nodes);
    Random random(5);
    for (AssetNode& node : out.nodes) {
        node.parent = moved(node.parent);
        node.name = "mixamorig:" + node.name;
        node.parent_from_node.rotation = random.rotation();
    }
    for (AssetSkin& skin : out.skins)
        for (uint32_t& joint : skin.joints) joint = moved(joint);
    for (AssetMeshInstance& instance : out.mesh_instances) instance.node = moved(instance.node);
    std::ranges::sort(out.mesh_instances, {}, &AssetMeshInstance::node);
    return out;
}

Asset with_meshes(Asset asset, const Asset& from) {
    const Result<void> added = add_meshes(asset, from);
    EXPECT_TRUE(added) << added.error().text();
    return asset;
}

std::vector<Vec3<double>> positions(const Character& character, uint32_t clip, float time_s) {
    const ReferencePose pose =
        reference_pose(character, {.first = {.clip = clip, .time_s = time_s, .loop = false}}).expect();
    return skin_reference(character, pose.model_from_bind);
}

Character without_lods(const Asset& asset) { return compile_character(asset, {.error = 0, .lods = false}).expect(); }

// The meshes of `whole` have been added to it once more: both move in the same way.
void expect_twins(const Asset& twice, const Asset& whole) {
    EXPECT_TRUE(twice.warnings.empty()) << twice.warnings[0];
    const Character character = without_lods(twice);
    EXPECT_EQ(character.rig.joint_count(), without_lods(whole).rig.joint_count());
    const size_t half = character.sections.size() / 2;
    ASSERT_EQ(character.sections.size(), 2 * without_lods(whole).sections.size());
    const uint32_t first = character.sections[half].first_vertex;
    for (uint32_t clip = 0; clip < whole.clips.size(); ++clip) {
        const std::vector<Vec3<double>> all = positions(character, clip, 0.31f);
        ASSERT_EQ(all.size(), 2 * size_t{first});
        double farthest = 0;
        for (size_t i = 0; i < first; ++i) farthest = std::max(farthest, length(all[i] - all[first + i]));
        EXPECT_LT(farthest, 1e-5 * double{character.size}) << whole.clips[clip].name;
    }
}

void enlarge(Asset& of, double scale) {
    for (AssetNode& node : of.nodes) node.parent_from_node.translation = node.parent_from_node.translation * scale;
    for (AssetSkin& skin : of.skins)
        for (Affine& bind : skin.inverse_binds)
            for (auto& row : bind.row) row[3] *= static_cast<float>(scale);
    for (AssetMesh& mesh : of.meshes)
        for (AssetPrimitive& primitive : mesh.primitives)
            for (Vec3<float>& position : primitive.positions) position = position * static_cast<float>(scale);
}

TEST(AddMeshes, MoveLikeTheCharactersOwn) {
    const Asset whole = walker_asset();
    expect_twins(with_meshes(whole, clothes_of(whole)), whole);
}

TEST(AddMeshes, FitARigOfAnotherSizeOrUnit) {
    const Asset whole = walker_asset();
    Asset larger = clothes_of(whole);
    enlarge(larger, 7);
    expect_twins(with_meshes(whole, larger), whole);

    // In centimetres, below a node that makes them metres.
    Asset held = clothes_of(whole);
    enlarge(held, 100);
    const auto holder = static_cast<uint32_t>(held.nodes.size());
    for (AssetNode& node : held.nodes)
        if (node.parent == kNone) node.parent = holder;
    held.nodes.push_back({.name = "Armature", .parent_from_node = {.scale = {0.01, 0.01, 0.01}}});
    for (AssetSkin& skin : held.skins)
        for (Affine& bind : skin.inverse_binds)
            for (auto& row : bind.row)
                for (size_t column = 0; column < 3; ++column) row[column] *= 100;
    for (AssetMesh& mesh : held.meshes)
        for (AssetPrimitive& primitive : mesh.primitives)
            for (Vec3<float>& position : primitive.positions) position = position * 0.01f;
    expect_twins(with_meshes(whole, held), whole);
}

AssetMesh triangle(bool is_skinned) {
    AssetPrimitive primitive{.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, .indices = {0, 1, 2}};
    if (is_skinned) {
        primitive.influence_count = 4;
        primitive.influence_joints = std::vector<uint16_t>(12);
        primitive.influence_weights = {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0};
    }
    return {.primitives = {primitive}};
}

// hips, then a hand one unit to the side; both are joints.
Asset body() {
    Asset asset{.name = "body.glb",
                .nodes = {{.name = "hips"}, {.name = "hand", .parent = 0}, {.name = "Body"}},
                .skins = {{.joints = {0, 1}, .inverse_binds = std::vector<Affine>(2)}},
                .meshes = {triangle(true)},
                .mesh_instances = {{.node = 2, .mesh = 0, .skin = 0}}};
    asset.nodes[1].parent_from_node.translation = {1, 0, 0};
    return asset;
}

Vec3<double> corner(const Character& character, uint32_t section) {
    return positions(character, kNone, 0)[character.sections[section].first_vertex];
}

TEST(AddMeshes, RigidMeshesHangOnTheirJoints) {
    Asset sword{.name = "things/sword.glb",
                .nodes = {{.name = "hips"},
                          {.name = "hand", .parent = 0},
                          {.name = "grip", .parent = 1},
                          {.name = "sword", .parent = 2}},
                .meshes = {triangle(false)},
                .mesh_instances = {{.node = 1, .mesh = 0}, {.node = 3, .mesh = 0}}};
    sword.nodes[1].parent_from_node.translation = {2, 0, 0};  // twice as large
    sword.nodes[2].parent_from_node.translation = {0, 4, 0};
    sword.nodes[3].parent_from_node.translation = {0, 0, 6};
    const Asset armed = with_meshes(body(), sword);
    EXPECT_TRUE(armed.warnings.empty());
    const Character character = without_lods(armed);
    EXPECT_EQ(character.rig.joint_count(), 2u) << "nothing moves grip and sword by themselves";
    ASSERT_EQ(character.section_names, (std::vector<std::string>{"Body", "hand", "sword"}));
    EXPECT_EQ(corner(character, 1), (Vec3<double>{1, 0, 0}));
    EXPECT_EQ(corner(character, 2), (Vec3<double>{1, 2, 3}));
    const std::vector<Vec3<double>> all = positions(character, kNone, 0);
    EXPECT_EQ(all[character.sections[2].first_vertex + 1], (Vec3<double>{1.5, 2, 3})) << "half as large";
}

// Names of nodes that are no joints mean nothing: another thing has a grip too.
TEST(AddMeshes, OnlyTheRigIsMatchedByName) {
    const auto thing = [](const char* name, double x) {
        Asset asset{.name = std::string(name) + ".glb",
                    .nodes = {{.name = "hand"}, {.name = "grip", .parent = 0}, {.name = name, .parent = 1}},
                    .skins = {{.joints = {0}, .inverse_binds = std::vector<Affine>(1)}},
                    .meshes = {triangle(false)},
                    .mesh_instances = {{.node = 2, .mesh = 0}}};
        asset.nodes[1].parent_from_node.translation = {x, 0, 0};
        return asset;
    };
    const Character armed = without_lods(with_meshes(with_meshes(body(), thing("sword", 5)), thing("axe", 7)));
    ASSERT_EQ(armed.section_names, (std::vector<std::string>{"Body", "sword", "axe"}));
    EXPECT_EQ(corner(armed, 1), (Vec3<double>{6, 0, 0}));
    EXPECT_EQ(corner(armed, 2), (Vec3<double>{8, 0, 0}));

    // A joint that is called like a mesh of the character.
    Asset tail = body();
    tail.name = "tail.glb";
    tail.nodes[2].name = "Tail";
    tail.nodes.push_back({.name = "Body", .parent = 1, .parent_from_node = {.translation = {0, 0, -1}}});
    tail.skins[0].joints = {3, 1};
    const Asset tailed = with_meshes(body(), tail);
    EXPECT_EQ(tailed.warnings.size(), 1u);
    EXPECT_EQ(corner(without_lods(tailed), 1), (Vec3<double>{1, 0, -1}));
}

// A bone of another length, such as one that ends in a weapon, is no other size.
TEST(AddMeshes, AreNotScaledForASingleBone) {
    const Asset whole = walker_asset();
    Asset clothes = clothes_of(whole);
    const auto is_leaf = [&](uint32_t node) {
        return std::ranges::none_of(clothes.nodes, [&](const AssetNode& other) { return other.parent == node; });
    };
    for (uint32_t node = 0; node < clothes.nodes.size(); ++node) {
        if (!is_leaf(node) || clothes.nodes[node].parent == kNone) continue;
        clothes.nodes[node].parent_from_node.translation = clothes.nodes[node].parent_from_node.translation * 9.0;
        break;
    }
    expect_twins(with_meshes(whole, clothes), whole);
}

// As files of gloves or hats have: few joints, which share more than a prefix.
TEST(AddMeshes, PrefixesAreFoundInFilesWithFewJoints) {
    Asset glove = body();
    glove.name = "glove.glb";
    glove.nodes[0].name = "mixamorigHips";
    glove.nodes[1].name = "mixamorigHand";
    glove.nodes[2].name = "Glove";
    glove.skins[0] = {.joints = {1}, .inverse_binds = std::vector<Affine>(1)};
    const Asset gloved = with_meshes(body(), glove);
    EXPECT_TRUE(gloved.warnings.empty());
    EXPECT_EQ(without_lods(gloved).rig.joint_count(), 2u);
    EXPECT_EQ(corner(without_lods(gloved), 1), (Vec3<double>{1, 0, 0}));
}

// A joint that is added goes on moving the mesh at its node, and what hangs on a mesh goes on hanging on it.
TEST(AddMeshes, MeshesOfAddedNodesFollowThem) {
    Asset cape = body();
    cape.name = "cape.glb";
    cape.nodes[2] = {.name = "clasp", .parent = 1, .parent_from_node = {.translation = {0, 0, -1}}};
    cape.nodes.push_back({.name = "Cape"});
    cape.nodes.push_back({.name = "box", .parent = 1, .parent_from_node = {.translation = {0, 2, 0}}});
    cape.nodes.push_back({.name = "gem", .parent = 4, .parent_from_node = {.translation = {0, 0, 3}}});
    cape.skins[0].joints = {2, 1};
    cape.meshes.push_back(triangle(false));
    cape.mesh_instances = {
        {.node = 2, .mesh = 1}, {.node = 3, .mesh = 0, .skin = 0}, {.node = 4, .mesh = 1}, {.node = 5, .mesh = 1}};
    const Asset dressed = with_meshes(body(), cape);
    const auto node_of_section = [&](const Character& character, uint32_t section) {
        return dressed.nodes[character.sections[section].node];
    };
    const Character character = without_lods(dressed);
    ASSERT_EQ(character.section_names, (std::vector<std::string>{"Body", "clasp", "Cape", "box", "gem"}));
    ASSERT_NE(character.rig.find_joint("clasp"), kNone);
    EXPECT_EQ(node_of_section(character, 1).parent, character.rig.nodes[character.rig.find_joint("clasp")]);
    EXPECT_EQ(node_of_section(character, 4).parent, character.sections[3].node);
    EXPECT_EQ(corner(character, 1), (Vec3<double>{1, 0, -1}));
    EXPECT_EQ(corner(character, 3), (Vec3<double>{1, 2, 0}));
    EXPECT_EQ(corner(character, 4), (Vec3<double>{1, 2, 3}));
}

TEST(AddMeshes, JointsThatAreMissingAreAdded) {
    Asset cape = body();
    cape.name = "cape.glb";
    cape.nodes[2].name = "Cape";
    cape.nodes.push_back({.name = "cape", .parent = 1, .parent_from_node = {.translation = {0, 0, -1}}});
    cape.skins[0].joints = {3, 1};
    const Asset dressed = with_meshes(body(), cape);
    EXPECT_EQ(dressed.warnings,
              std::vector<std::string>{
                  "cape.glb: 1 of its 2 joints ('cape') are not in body.glb and are added: no clip moves them"});
    const Character character = without_lods(dressed);
    EXPECT_EQ(character.rig.names, (std::vector<std::string>{"hips", "hand", "cape"}));
    EXPECT_EQ(character.rig.parents[2], 1u);
    EXPECT_EQ(corner(character, 1), (Vec3<double>{1, 0, -1}));
}

TEST(AddMeshes, NamesImagesAndMaterialsDoNotMix) {
    Asset asset = body(), other = body();
    const auto painted = [](Asset& of, const std::vector<std::string>& images) {
        for (const std::string& image : images) {
            const auto bytes = std::as_bytes(std::span(image));
            of.images.push_back({.name = image, .encoded = {bytes.begin(), bytes.end()}});
            of.materials.push_back(
                {.name = of.name + " " + image, .image = static_cast<uint32_t>(of.images.size() - 1)});
        }
        of.meshes[0].primitives[0].material = 0;
    };
    other.name = "coat.glb";
    painted(asset, {"skin", "colours"});
    painted(other, {"colours", "cloth"});
    other.nodes.push_back({.name = "Body"});
    other.mesh_instances.push_back({.node = 3, .mesh = 0, .skin = 0});
    add_meshes(asset, other).expect();
    add_meshes(asset, other).expect();
    const Character character = without_lods(asset);
    EXPECT_EQ(character.section_names,
              (std::vector<std::string>{"Body", "coat Body", "coat Body", "coat Body 2", "coat Body 2"}))
        << "those that share a name keep sharing one";
    EXPECT_EQ(asset.images.size(), 3u) << "colours and cloth are taken once";
    const AssetMaterial& material = character.materials[character.sections[1].material];
    EXPECT_EQ(material.name, "coat.glb colours");
    EXPECT_EQ(asset.images[material.image].name, "colours");
    EXPECT_EQ(asset.images[asset.materials[character.find_material("coat.glb cloth")].image].name, "cloth");
    EXPECT_EQ(character.materials[character.sections[0].material].name, "body.glb skin");
}

TEST(AddMeshes, AreRefusedWhereTheyDoNotFit) {
    const auto expect_refused = [](Asset asset, const Asset& from, const std::string& message) {
        const size_t node_count = asset.nodes.size();
        const Result<void> added = add_meshes(asset, from);
        ASSERT_FALSE(added) << message;
        EXPECT_EQ(added.error().code, ErrorCode::kInvalidArgument);
        EXPECT_TRUE(contains(added.error().text(), message)) << added.error().text();
        EXPECT_EQ(asset.nodes.size(), node_count);
        EXPECT_EQ(asset.meshes.size(), 1u);
    };
    Asset other = body();
    other.name = "other.glb";
    for (AssetNode& node : other.nodes) node.name += " of something else";
    expect_refused(body(), other,
                   "other.glb: its meshes follow none of the joints of body.glb, which has 'hips', 'hand', …");
    Asset empty = body();
    empty.mesh_instances.clear();
    expect_refused(body(), empty, "has no meshes to add to body.glb");
    Asset broken = body();
    broken.skins[0].joints[1] = 1000;
    expect_refused(body(), broken, "a joint is 1000");
    Asset asset = body();
    asset.clips = {{.name = "clip", .tracks = {{.node = 1000}}}};
    expect_refused(asset, body(), "clips[0].tracks[0]");
}

}  // namespace
}  // namespace throng
