// Importing nodes, scenes and skins.
#include "tests/host/import_cases.h"
#include "tests/test_rig.h"

#include <cmath>

namespace throng::test {
namespace {

TEST(Import, NodeMatrix) {
    // Rotation by 120° about (1, 1, 1), scale (2, 3, -4): columns are y·2, z·3, x·-4.
    GlbBuilder b = tiny_character();
    b.json["nodes"][1]["matrix"] = {0, 2, 0, 0, 0, 0, 3, 0, -4, 0, 0, 0, 5, 6, 7, 1};
    const Asset asset = loaded(b);
    EXPECT_TRUE(asset.warnings.empty());
    const Trs<double>& t = asset.nodes[1].parent_from_node;
    EXPECT_EQ(t.translation, (Vec3<double>{5, 6, 7}));
    EXPECT_EQ(t.scale, (Vec3<double>{-2, 3, 4}));  // the mirroring moves to x
    const AffineT<double> m = to_affine(t);
    const double expected[3][3] = {{0, 0, -4}, {2, 0, 0}, {0, 3, 0}};
    for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(m.row[size_t(r)][size_t(c)], expected[r][c], 1e-12);

    // Covers all branches of the conversion to a quaternion.
    for (int turn = 0; turn < 64; ++turn) {
        const Trs<double> in{normalized(Quaternion<double>{double(turn % 4) - 1.5, double(turn / 4 % 4) - 1.4,
                                                           double(turn / 16) - 1.3, 0.2}),
                             {},
                             {1, 2, 3}};
        const AffineT<double> a = to_affine(in);
        GltfJson matrix;
        for (size_t c = 0; c < 4; ++c)
            for (size_t r = 0; r < 4; ++r) matrix.push_back(r < 3 ? a.row[r][c] : c == 3 ? 1.0 : 0.0);
        b.json["nodes"][1]["matrix"] = matrix;
        const auto out = loaded(b).nodes[1].parent_from_node;
        EXPECT_NEAR(std::abs(dot(in.rotation, out.rotation)), 1, 1e-12) << turn;
        EXPECT_NEAR(out.scale.z, 3, 1e-12);
    }
}

TEST(Import, OddNodeMatrices) {
    GlbBuilder b = tiny_character();
    b.json["nodes"][1]["matrix"] = {1, 0, 0, 0, 0.5, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    EXPECT_TRUE(has_warning(loaded(b), "nodes[1].matrix: has shear"));
    b.json["nodes"][1]["translation"] = {1, 2, 3};
    EXPECT_TRUE(has_warning(loaded(b), "nodes[1]: has both"));
    // Matrices that flatten still give a unit rotation.
    for (const GltfJson& flat : {GltfJson{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1},
                                 GltfJson{0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1},
                                 GltfJson{0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1}}) {
        GlbBuilder c = tiny_character();
        c.json["nodes"][1]["matrix"] = flat;
        const Quaternion<double> q = loaded(c).nodes[1].parent_from_node.rotation;
        EXPECT_NEAR(dot(q, q), 1, 1e-12);
    }
    b.json["nodes"][1]["matrix"] = {1, 0, 0};
    expect_refused(b, "nodes[1].matrix", "must have 16 numbers");
}

TEST(Import, NodeRotations) {
    GlbBuilder b = tiny_character();
    b.json["nodes"][1]["rotation"] = {0, 0, 0, 2};
    Asset asset = loaded(b);
    EXPECT_EQ(asset.nodes[1].parent_from_node.rotation, (Quaternion<double>{0, 0, 0, 1}));
    EXPECT_TRUE(has_warning(asset, "nodes[1].rotation: is not of unit length"));
    b.json["nodes"][1]["rotation"] = {0, 0, 0, 0};
    EXPECT_EQ(loaded(b).nodes[1].parent_from_node.rotation, (Quaternion<double>{}));
    b.json["nodes"][1]["rotation"] = {0, 0, 1};
    expect_refused(b, "nodes[1].rotation", "must have 4 numbers, but has 3");
    b.json["nodes"][1]["rotation"] = {0, 0, "x", 1};
    expect_refused(b, "nodes[1].rotation[2]", "must be a number, but is a string");
    b.json["nodes"][1] = {{"translation", {0, 1e300, 0}}};
    expect_refused(b, "nodes[1].translation[1]", "does not fit");
}

TEST(Import, NodeTree) {
    GlbBuilder b = tiny_character();
    b.json["nodes"][2]["children"] = {1};
    expect_refused(b, "nodes[1]", "is its own ancestor");
    b.json["nodes"][2]["children"] = {2};
    expect_refused(b, "nodes[2].children[0]", "is a child of nodes[1] already");
    b.json["nodes"][2]["children"] = {3};
    expect_refused(b, "nodes[2].children[0]", "index 3, but nodes has 3 entries");
    b.json["nodes"][2]["children"] = {-1};
    expect_refused(b, "nodes[2].children[0]", "-1");
    b.json["nodes"][2]["children"] = {0.5};
    expect_refused(b, "nodes[2].children[0]", "0.5");
    b.json["nodes"][2]["children"] = {0.0};  // counts as an integer
    EXPECT_EQ(loaded(b).nodes[0].parent, 2u);
    b.json["nodes"] = {7};
    expect_refused(b, "nodes[0]", "must be an object");
}

TEST(Import, DeepChain) {
    constexpr uint32_t kDepth = 200'000;
    GlbBuilder b = tiny_character();
    b.json["nodes"][2]["children"] = {3};
    // Inserted as text: as JSON objects, so many would take longer than all that is tested
    const std::string text = b.gltf(), nodes = b.json["nodes"].dump();
    const size_t end_of_nodes = text.find(nodes) + nodes.size() - 1;
    ASSERT_EQ(text[end_of_nodes], ']');
    std::string chain;
    for (uint32_t i = 3; i < kDepth; ++i) chain += ",{\"children\":[" + std::to_string(i + 1) + "]}";
    const auto load_with_last = [&](const std::string& last) {
        return load(std::string(text).insert(end_of_nodes, chain + "," + last));
    };
    const Result<Asset> asset = load_with_last(R"({"mesh":0})");
    ASSERT_TRUE(asset) << asset.error().text();
    ASSERT_EQ(asset->mesh_instances.size(), 2u);
    EXPECT_EQ(asset->mesh_instances[1].node, kDepth);
    expect_refused(load_with_last(R"({"mesh":0,"children":[1]})"), ErrorCode::kInvalidFile, "nodes[1]",
                   "is its own ancestor");
}

TEST(Import, Scenes) {
    GlbBuilder b = tiny_character();
    b.json["nodes"][2]["mesh"] = 0;            // without skin: follows node 2 rigidly
    b.json["nodes"].push_back({{"mesh", 0}});  // in no scene
    b.json["nodes"].push_back({{"skin", 0}});  // has no mesh
    Asset asset = loaded(b);
    ASSERT_EQ(asset.mesh_instances.size(), 2u);
    EXPECT_EQ(asset.mesh_instances[1].node, 2u);
    EXPECT_EQ(asset.mesh_instances[1].skin, kNone);
    b.json["scenes"] = {{{"nodes", {0}}}, {{"nodes", {3}}}};
    b.json["scene"] = 1;
    asset = loaded(b);
    ASSERT_EQ(asset.mesh_instances.size(), 1u);
    EXPECT_EQ(asset.mesh_instances[0].node, 3u);
    b.json.erase("scene");
    EXPECT_EQ(loaded(b).mesh_instances.at(0).node, 0u);
    b.json["scenes"] = {{{"nodes", {2}}}};
    asset = loaded(b);
    EXPECT_EQ(asset.mesh_instances.at(0).node, 2u);
    EXPECT_TRUE(has_warning(asset, "scenes[0].nodes[0]: is not a root node"));
    b.json.erase("scenes");
    EXPECT_EQ(loaded(b).mesh_instances.size(), 3u);
    b.json["scene"] = 0;
    expect_refused(b, "scene", "index 0, but scenes has no entries");
    b.json["scenes"] = {{{"nodes", {9}}}};
    expect_refused(b, "scenes[0].nodes[0]", "index 9");
    b = tiny_character();
    b.json["nodes"][0]["mesh"] = 1;
    expect_refused(b, "nodes[0].mesh", "index 1, but meshes has 1 entry");
    b.json["nodes"][0] = {{"skin", 1}};
    expect_refused(b, "nodes[0].skin", "index 1, but skins has 1 entry");
}

TEST(Import, HiddenNodesAreNotDrawn) {
    const auto hide = [](GlbBuilder& b, size_t node, const GltfJson& visible) {
        b.json["nodes"][node]["extensions"]["KHR_node_visibility"]["visible"] = visible;
    };
    GlbBuilder b = tiny_character();
    b.json["extensionsUsed"] = b.json["extensionsRequired"] = {"KHR_node_visibility"};
    b.json["nodes"][2]["mesh"] = 0;
    EXPECT_EQ(loaded(b).mesh_instances.size(), 2u);
    hide(b, 1, false);
    hide(b, 2, true);  // below a hidden node, though marked as visible
    for (const bool with_scene : {true, false}) {
        if (!with_scene) b.json.erase("scenes"), b.json.erase("scene");
        const Asset asset = loaded(b);
        ASSERT_EQ(asset.mesh_instances.size(), 1u);
        EXPECT_EQ(asset.mesh_instances[0].node, 0u);
        EXPECT_EQ(asset.skins.at(0).joints, (std::vector<uint32_t>{1, 2})) << "joints work, hidden or not";
        EXPECT_TRUE(asset.warnings.empty());
    }
    hide(b, 0, false);
    EXPECT_TRUE(loaded(b).mesh_instances.empty());
    hide(b, 0, "no");
    expect_refused(b, "nodes[0].extensions.KHR_node_visibility.visible", "must be");
}

TEST(Import, InstancingThatIsNotShownIsAWarning) {
    GlbBuilder b = tiny_character();
    b.json["extensionsUsed"] = {"EXT_mesh_gpu_instancing"};
    EXPECT_TRUE(has_warning(loaded(b), "extensionsUsed[0]: EXT_mesh_gpu_instancing is not supported"));
}

TEST(Import, Skins) {
    GlbBuilder b = tiny_character();
    b.json["skins"][0].erase("inverseBindMatrices");
    const Asset asset = loaded(b);
    EXPECT_EQ(asset.skins[0].inverse_binds, std::vector<Affine>(2));
    b = tiny_character();
    b.json["accessors"][kInverseBinds]["count"] = 1;
    expect_refused(b, "skins[0].inverseBindMatrices", "has 1 matrices for 2 joints");
    b.json["accessors"][kInverseBinds]["type"] = "VEC4";
    expect_refused(b, "skins[0].inverseBindMatrices", "must be MAT4 of floats, but is VEC4");
    b = tiny_character();
    overwrite(b, kInverseBinds, 20, kNan);
    expect_refused(b, "skins[0].inverseBindMatrices", "matrix 1 is not finite");
    overwrite(b, kInverseBinds, 20, 0.0f);
    overwrite(b, kInverseBinds, 19, kNan);  // in the fourth row, which is not used
    EXPECT_TRUE(load(b).ok());
    b.json["skins"][0]["skeleton"] = 3;
    expect_refused(b, "skins[0].skeleton", "index 3");
    b.json["skins"][0]["joints"] = {1, 1};
    b.json["skins"][0].erase("skeleton");
    EXPECT_TRUE(has_warning(loaded(b), "skins[0].joints[1]: nodes[1] is a joint of this skin twice"));
    b.json["skins"][0]["joints"] = {1, -2};
    expect_refused(b, "skins[0].joints[1]");
    b.json["skins"][0]["joints"] = {3, 1};
    expect_refused(b, "skins[0].joints[0]", "index 3, but nodes has 3 entries");
    b.json["skins"][0]["joints"] = GltfJson::array();
    expect_refused(b, "skins[0].joints", "is empty");
    b.json["skins"][0].erase("joints");
    expect_refused(b, "skins[0].joints", "is missing");
}

}  // namespace
}  // namespace throng::test
