// Importing meshes: attributes, influences, indices.
#include "tests/host/import_cases.h"
#include "tests/test_rig.h"

namespace throng::test {
namespace {

TEST(Import, MissingNormalsAreComputed) {
    GlbBuilder b = tiny_character();
    attributes(b).erase("NORMAL");
    Asset asset = loaded(b);
    EXPECT_TRUE(has_warning(asset, "meshes[0].primitives[0]: 3 of 3 vertices have no normal")) << asset.warnings[0];
    EXPECT_EQ(asset.meshes[0].primitives[0].normals, (std::vector<Vec3<float>>(3, {0, 0, 1})));

    b = tiny_character();
    overwrite(b, kNormals, 3, 1.0f);  // of the second vertex, which points along x
    overwrite(b, kNormals, 5, 0.0f);
    overwrite(b, kNormals, 8, 0.0f);  // of the third vertex
    asset = loaded(b);
    EXPECT_TRUE(has_warning(asset, "1 of 3 vertices have no normal"));
    EXPECT_EQ(asset.meshes[0].primitives[0].normals, (std::vector<Vec3<float>>{{0, 0, 1}, {1, 0, 0}, {0, 0, 1}}));

    overwrite(b, kPosition, 3, 0.0f);  // a triangle of zero area: its normal is unknown
    asset = loaded(b);
    EXPECT_EQ(asset.meshes[0].primitives[0].normals[2], (Vec3<float>{}));
    EXPECT_TRUE(compile_character(asset));
}

TEST(Import, VertexAttributes) {
    GlbBuilder b = tiny_character();
    attributes(b)["NORMAL"] = b.add<float>({0, 0, 1, kNan, 0, 1, 0, 1, 0}, "VEC3", kFloat);
    attributes(b)["TEXCOORD_0"] = b.add<uint16_t>({0, 65535, 65535, 0, 0, 0}, "VEC2", kUint16);
    b.json["accessors"].back()["normalized"] = true;
    attributes(b)["TEXCOORD_1"] = b.add<float>({1, 2, 3, 4, 5, 6}, "VEC2", kFloat);
    attributes(b)["COLOR_0"] = b.add<float>({1, 0.5f, 0, 0, 0, 0, 1, 1, 1}, "VEC3", kFloat);
    Asset asset = loaded(b);
    const AssetPrimitive& p = asset.meshes[0].primitives[0];
    EXPECT_EQ(p.normals[0], (Vec3<float>{0, 0, 1}));
    EXPECT_EQ(p.normals[1], (Vec3<float>{0, 0, 1}));  // replaced
    EXPECT_TRUE(has_warning(asset, "meshes[0].primitives[0].attributes.NORMAL: has values that are not finite"));
    EXPECT_EQ(p.texcoords[0], (std::array<float, 2>{0, 1}));
    EXPECT_EQ(p.colors[0], (std::array<float, 4>{1, 0.5f, 0, 1}));

    b.json["images"] = {{{"uri", "data:image/png;base64,AAAA"}}};
    b.json["textures"] = {{{"source", 0}}};
    b.json["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}, {"texCoord", 1}}}}}}};
    primitive(b)["material"] = 0;
    EXPECT_EQ(loaded(b).meshes[0].primitives[0].texcoords[2], (std::array<float, 2>{5, 6}));
    b.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["texCoord"] = 7;
    asset = loaded(b);
    EXPECT_TRUE(asset.meshes[0].primitives[0].texcoords.empty());
    EXPECT_TRUE(has_warning(asset, "no texture coordinates"));
}

TEST(Import, BrokenAttributes) {
    const std::string place = "meshes[0].primitives[0].attributes";
    GlbBuilder b = tiny_character();
    overwrite(b, kPosition, 4, kNan);
    expect_refused(b, place + ".POSITION", "vertex 1 is not finite");
    b = tiny_character();
    b.json["accessors"][kPosition]["type"] = "VEC2";
    expect_refused(b, place + ".POSITION", "must be VEC3, but is VEC2");
    b = tiny_character();
    attributes(b)["POSITION"] = 70;
    expect_refused(b, place + ".POSITION", "index 70");
    b = tiny_character();
    attributes(b)["NORMAL"] = kTimes;
    expect_refused(b, place + ".NORMAL", "has 2 elements, but POSITION has 3");
    b = tiny_character();
    attributes(b).erase("POSITION");
    EXPECT_TRUE(has_warning(loaded(b), "meshes[0].primitives[0]: has no POSITION"));
    primitive(b).erase("attributes");
    EXPECT_TRUE(load(b).ok());
    primitive(b)["attributes"] = 5;
    expect_refused(b, place, "must be an object");
    primitive(b)["material"] = 0;
    expect_refused(b, "meshes[0].primitives[0].material", "index 0, but materials has no entries");
    b.json["meshes"][0].erase("primitives");
    expect_refused(b, "meshes[0].primitives", "is missing");
}

TEST(Import, Quantised) {
    GlbBuilder b = tiny_character();
    attributes(b)["POSITION"] = b.add<int16_t>({1, -2, 300, 4, 5, 6, 7, 8, 9}, "VEC3", kInt16);
    attributes(b)["NORMAL"] = b.add<int8_t>({127, 0, -127, -128, 0, 0, 0, 0, 0}, "VEC3", kInt8);
    b.json["accessors"].back()["normalized"] = true;
    attributes(b)["TEXCOORD_0"] = b.add<uint8_t>({1, 2, 3, 4, 5, 6}, "VEC2", kUint8);
    expect_refused(b, "meshes[0].primitives[0].attributes.POSITION", "without KHR_mesh_quantization");
    b.json["extensionsUsed"] = b.json["extensionsRequired"] = {"KHR_mesh_quantization"};
    const Asset asset = loaded(b);
    const AssetPrimitive& p = asset.meshes[0].primitives[0];
    EXPECT_EQ(p.positions[0], (Vec3<float>{1, -2, 300}));
    EXPECT_EQ(p.normals[0], (Vec3<float>{1, 0, -1}));
    EXPECT_EQ(p.normals[1], (Vec3<float>{-1, 0, 0}));
    EXPECT_EQ(p.texcoords[2], (std::array<float, 2>{5, 6}));
}

// The vertices of two triangles among five that two primitives share. No primitive uses number 3, which is broken.
GlbBuilder shared_vertices() {
    GlbBuilder b = tiny_character();
    std::vector<float> positions, normals, texcoords, colors, weights, moved;
    std::vector<uint8_t> joints;
    for (int i = 0; i < 5; ++i) {
        const auto v = float(i);
        const float x = i == 3 ? kNan : v;
        positions.insert(positions.end(), {x, v * v, 0});
        normals.insert(normals.end(), {0, 0, v + 1});
        texcoords.insert(texcoords.end(), {v, x});
        colors.insert(colors.end(), {v / 4, 0, x, 1});
        weights.insert(weights.end(), {(v + 1) / 8, x, 0, 0});
        joints.insert(joints.end(), {uint8_t(i % 2), uint8_t(i == 3 ? 99 : 1), 0, 0});
        moved.insert(moved.end(), {x, 0, v});
    }
    attributes(b) = {{"POSITION", b.add(positions, "VEC3", kFloat)},   {"NORMAL", b.add(normals, "VEC3", kFloat)},
                     {"TEXCOORD_0", b.add(texcoords, "VEC2", kFloat)}, {"COLOR_0", b.add(colors, "VEC4", kFloat)},
                     {"JOINTS_0", b.add(joints, "VEC4", kUint8)},      {"WEIGHTS_0", b.add(weights, "VEC4", kFloat)}};
    const size_t differences = b.add(moved, "VEC3", kFloat);
    primitive(b)["targets"] = {{{"POSITION", differences}, {"NORMAL", differences}}};
    primitive(b)["indices"] = b.add<uint16_t>({4, 2, 0}, "SCALAR", kUint16);
    b.json["meshes"][0]["primitives"].push_back(primitive(b));
    b.json["meshes"][0]["primitives"][1]["indices"] = b.add<uint16_t>({1, 4, 2, 1}, "SCALAR", kUint16);
    b.json["meshes"][0]["primitives"][1]["mode"] = 5;
    return b;
}

TEST(Import, VerticesThatNoTriangleNamesAreLeftOut) {
    const Asset asset = loaded(shared_vertices());
    EXPECT_TRUE(asset.warnings.empty()) << asset.warnings[0];
    ASSERT_EQ(asset.meshes.at(0).primitives.size(), 2u);
    const std::vector<float> kept[2] = {{0, 2, 4}, {1, 2, 4}};
    for (size_t k = 0; k < 2; ++k) {
        const AssetPrimitive& p = asset.meshes[0].primitives[k];
        ASSERT_EQ(p.positions.size(), 3u);
        ASSERT_EQ(p.targets.size(), 1u);
        ASSERT_EQ(p.influence_joints.size(), 12u);
        ASSERT_EQ(p.influence_weights.size(), 12u);
        for (size_t i = 0; i < 3; ++i) {
            const float v = kept[k][i];
            EXPECT_EQ(p.positions[i], (Vec3<float>{v, v * v, 0}));
            EXPECT_EQ(p.normals.at(i), (Vec3<float>{0, 0, v + 1}));
            EXPECT_EQ(p.texcoords.at(i), (std::array<float, 2>{v, v}));
            EXPECT_EQ(p.colors.at(i), (std::array<float, 4>{v / 4, 0, v, 1}));
            EXPECT_EQ(p.influence_weights[4 * i], (v + 1) / 8);
            EXPECT_EQ(p.influence_weights[4 * i + 1], v);
            EXPECT_EQ(p.influence_joints[4 * i], int(v) % 2);
            EXPECT_EQ(p.targets[0].positions.at(i), (Vec3<float>{v, 0, v}));
            EXPECT_EQ(p.targets[0].normals.at(i), (Vec3<float>{v, 0, v}));
        }
    }
    EXPECT_EQ(asset.meshes[0].primitives[0].indices, (std::vector<uint32_t>{2, 1, 0}));
    EXPECT_EQ(asset.meshes[0].primitives[1].indices, (std::vector<uint32_t>{0, 2, 1, 2, 0, 1}));
}

TEST(Import, VerticesAreNamedByTheirNumbersInTheFile) {
    const std::string place = "meshes[0].primitives[0]";
    const GlbBuilder good = shared_vertices();
    const GltfJson& of = good.json["meshes"][0]["primitives"][0];
    GlbBuilder b = good;
    overwrite(b, of["attributes"]["POSITION"], 4 * 3, kInfinity);
    expect_refused(b, place + ".attributes.POSITION", "vertex 4 is not finite");
    b = good;
    overwrite(b, of["targets"][0]["POSITION"], 4 * 3, kInfinity);
    expect_refused(b, place + ".targets[0].POSITION", "vertex 4 is not finite");
    b = good;
    overwrite<uint8_t>(b, of["attributes"]["JOINTS_0"], 4 * 4, 2);
    expect_refused(b, place + ".attributes.JOINTS_0", "vertex 4 follows joint 2, but skins[0] has 2 joints");
}

TEST(Import, VerticesThatTrianglesNameAllKeepTheirOrder) {
    GlbBuilder b = tiny_character();
    primitive(b)["indices"] = b.add<uint8_t>({2, 0, 1}, "SCALAR", kUint8);
    const Asset asset = loaded(b);
    EXPECT_EQ(asset.meshes.at(0).primitives.at(0).indices, (std::vector<uint32_t>{2, 0, 1}));
    EXPECT_EQ(asset.meshes[0].primitives[0].positions, (std::vector<Vec3<float>>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
    // Without indices, this includes the vertices of an incomplete triangle.
    attributes(b) = {{"POSITION", b.add<float>({1, 1, 1, 2, 2, 2, 3, 3, 3, 4, 4, 4}, "VEC3", kFloat)}};
    b.json["nodes"][0].erase("skin");
    primitive(b).erase("indices");
    EXPECT_EQ(loaded(b).meshes[0].primitives[0].positions.size(), 4u);
}

TEST(Import, IntegersWhereTheyAreNotAllowedAreNormalised) {
    const std::string place = "file.glb: meshes[0].primitives[0].attributes.";
    const std::string normalised =
        " of 6 attributes, the first of them here, are integers that glTF does not allow "
        "there: they are taken as normalised";
    GlbBuilder good = tiny_character();
    attributes(good)["NORMAL"] = good.add<int8_t>({0, 0, 127, 0, -127, 0, 127, 0, 0}, "VEC3", kInt8);
    attributes(good)["TEXCOORD_0"] = good.add<uint16_t>({0, 65535, 13107, 0, 0, 0}, "VEC2", kUint16);
    attributes(good)["COLOR_0"] = good.add<uint8_t>({255, 51, 0, 1, 2, 3, 4, 5, 6}, "VEC3", kUint8);
    attributes(good)["WEIGHTS_0"] = good.add<uint8_t>({51, 204, 0, 0, 255, 0, 0, 0, 255, 0, 0, 0}, "VEC4", kUint8);
    const Asset asset = loaded(good);
    EXPECT_EQ(asset.warnings, (std::vector<std::string>{place + "NORMAL: 4" + normalised}));
    const AssetPrimitive& p = asset.meshes.at(0).primitives.at(0);
    EXPECT_EQ(p.normals, (std::vector<Vec3<float>>{{0, 0, 1}, {0, -1, 0}, {1, 0, 0}}));
    EXPECT_EQ(p.texcoords, (std::vector<std::array<float, 2>>{{0, 1}, {0.2f, 0}, {0, 0}}));
    EXPECT_EQ(p.colors.at(0), (std::array<float, 4>{1, 0.2f, 0, 1}));
    EXPECT_EQ(p.influence_weights[0], 0.2f);
    EXPECT_EQ(p.influence_weights[1], 0.8f);

    GlbBuilder b = good;
    b.json["meshes"][0]["primitives"].push_back(primitive(b));
    EXPECT_TRUE(has_warning(loaded(b), "8 of 12 attributes")) << "one line for all";
    // KHR_mesh_quantization allows unnormalised texture coordinates. They stay as they are.
    b = good;
    b.json["extensionsUsed"] = {"KHR_mesh_quantization"};
    const Asset quantized = loaded(b);
    EXPECT_EQ(quantized.meshes.at(0).primitives.at(0).texcoords.at(1), (std::array<float, 2>{13107, 0}));
    EXPECT_EQ(quantized.warnings, (std::vector<std::string>{place + "NORMAL: 3" + normalised}));
    // Signed and 32-bit colours are not defined.
    b = good;
    attributes(b)["COLOR_0"] = b.add<int8_t>({1, 2, 3, 4, 5, 6, 7, 8, 9}, "VEC3", kInt8);
    expect_refused(b, "meshes[0].primitives[0].attributes.COLOR_0", "must not be 8-bit integers");
    attributes(b)["COLOR_0"] = b.add<uint32_t>({1, 2, 3, 4, 5, 6, 7, 8, 9}, "VEC3", kUint32);
    expect_refused(b, "meshes[0].primitives[0].attributes.COLOR_0", "must not be unsigned 32-bit integers");
}

TEST(Import, NormalsOfAWrongFormatAreMade) {
    GlbBuilder unsigned_ones = tiny_character(), four = tiny_character();
    attributes(unsigned_ones)["NORMAL"] = unsigned_ones.add<uint8_t>({9, 9, 9, 9, 9, 9, 9, 9, 9}, "VEC3", kUint8);
    attributes(four)["NORMAL"] = four.add(std::vector<float>(12, 1), "VEC4", kFloat);
    for (const GlbBuilder& b : {unsigned_ones, four}) {
        const Asset asset = loaded(b);
        EXPECT_EQ(asset.warnings.size(), 2u);
        EXPECT_TRUE(has_warning(asset,
                                "meshes[0].primitives[0].attributes.NORMAL: 1 of 4 attributes, the first of them here, "
                                "have a format that normals cannot have: they are left out"));
        EXPECT_TRUE(has_warning(asset, "3 of 3 vertices have no normal"));
        EXPECT_EQ(asset.meshes.at(0).primitives.at(0).normals, (std::vector<Vec3<float>>(3, {0, 0, 1})));
    }
}

// The error names the primitive that needs the most joints, whichever it is.
TEST(Import, TheLargestJointOfAMeshIsChecked) {
    GlbBuilder b = tiny_character();
    b.json["meshes"][0]["primitives"].push_back(primitive(b));
    const size_t joints = b.add<uint8_t>({0, 5, 0, 0, 1, 0, 0, 0, 3, 0, 0, 0}, "VEC4", kUint8);
    overwrite<uint8_t>(b, kVertexJoints, 4, 2);
    b.json["meshes"][0]["primitives"][1]["attributes"]["JOINTS_0"] = joints;
    expect_refused(b, "meshes[0].primitives[1].attributes.JOINTS_0",
                   "vertex 0 follows joint 5, but skins[0] has 2 joints");
    b.json["nodes"][0].erase("skin");
    EXPECT_TRUE(load(b).ok());
}

TEST(Import, Influences) {
    const std::string place = "meshes[0].primitives[0].attributes";
    // Two sets of influences, the second with normalised integers.
    GlbBuilder b = tiny_character();
    attributes(b)["JOINTS_1"] = b.add<uint16_t>({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, "VEC4", kUint16);
    attributes(b)["WEIGHTS_1"] = b.add<uint8_t>({255, 0, 0, 0, 51, 0, 0, 0, 0, 0, 0, 0}, "VEC4", kUint8);
    b.json["accessors"].back()["normalized"] = true;
    const Asset asset = loaded(b);
    const AssetPrimitive& p = asset.meshes[0].primitives[0];
    EXPECT_EQ(p.influence_count, 8u);
    EXPECT_EQ(std::vector<float>(p.influence_weights.begin() + 8, p.influence_weights.begin() + 16),
              (std::vector<float>{1, 0, 0, 0, 0.2f, 0, 0, 0}));
    EXPECT_EQ(p.influence_joints[4], 1);
    attributes(b).erase("WEIGHTS_1");
    expect_refused(b, place, "there are 2 sets of JOINTS, but 1 of WEIGHTS");

    b = tiny_character();
    overwrite<uint8_t>(b, kVertexJoints, 3, 200);  // with weight 0
    EXPECT_EQ(loaded(b).meshes[0].primitives[0].influence_joints[3], 0);
    overwrite<uint8_t>(b, kVertexJoints, 4, 2);
    expect_refused(b, place + ".JOINTS_0", "vertex 1 follows joint 2, but skins[0] has 2 joints");
    b.json["nodes"][0].erase("skin");  // nothing uses the joints
    EXPECT_TRUE(load(b).ok());
    b = tiny_character();
    overwrite(b, kWeights, 1, -0.5f);
    const Asset negative = loaded(b);
    EXPECT_EQ(negative.meshes[0].primitives[0].influence_weights[1], 0);
    EXPECT_TRUE(has_warning(negative, place + ".WEIGHTS_0: 1 of 3 vertices have negative weights"));
    b = tiny_character();
    attributes(b)["JOINTS_0"] = kWeights;
    expect_refused(b, place + ".JOINTS_0", "must be VEC4 of unsigned");
    b = tiny_character();
    attributes(b)["JOINTS_2"] = kVertexJoints;
    EXPECT_TRUE(has_warning(loaded(b), "JOINTS_1: is missing"));
}

TEST(Import, WeightsThatAreNotFiniteAreZero) {
    const std::string place = "meshes[0].primitives[0].attributes.WEIGHTS_0: ";
    GlbBuilder b = tiny_character();
    overwrite(b, kWeights, 1, kInfinity);
    overwrite(b, kWeights, 2, -kInfinity);
    overwrite(b, kWeights, 11, kNan);
    overwrite<uint8_t>(b, kVertexJoints, 11, 200);
    Asset asset = loaded(b);
    EXPECT_EQ(asset.warnings.size(), 1u);
    EXPECT_TRUE(has_warning(asset, place + "2 of 3 vertices have weights that are not finite: they are set to 0"));
    const AssetPrimitive& p = asset.meshes[0].primitives[0];
    EXPECT_EQ(p.influence_weights, (std::vector<float>{0.25f, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}));
    EXPECT_EQ(p.influence_joints, (std::vector<uint16_t>{0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}));

    // If no weight is valid, each vertex follows its first joint, or the skin's first if the skin has no such joint.
    for (size_t i = 0; i < 12; ++i) overwrite(b, kWeights, i, kNan);
    for (size_t i = 0; i < 12; ++i) overwrite<uint8_t>(b, kVertexJoints, i, i == 8 ? 200 : 1);
    asset = loaded(b);
    EXPECT_EQ(asset.warnings.size(), 1u);
    EXPECT_TRUE(has_warning(asset, place + "3 of 3 vertices"));
    EXPECT_EQ(asset.meshes[0].primitives[0].influence_joints,
              (std::vector<uint16_t>{1, 0, 0, 0, 1, 0, 0, 0, 200, 0, 0, 0}));
    const Character character = *compile_character(asset);
    const auto positions = reference_positions(character, *reference_pose(character, {}));
    ASSERT_EQ(positions.size(), 3u);
    // The tip is at (1, -2, -3). Its inverse bind matrix translates by (-1, 2, 3).
    EXPECT_EQ(positions[1], (Vec3<double>{1, 0, 0}));
    EXPECT_EQ(positions[2], (Vec3<double>{0, 1, 0}));
    const auto turned = reference_pose(character, {.first = {.clip = 0, .time_s = 1, .loop = false}});
    const auto later = reference_positions(character, *turned);
    EXPECT_GT(length(later[1] - positions[1]), 1) << "follows joint 1, which turns";
    EXPECT_EQ(later[2], positions[2]) << "follows joint 0, which stands";
    ASSERT_EQ(character.warnings.size(), 2u);
    EXPECT_NE(character.warnings[1].find("3 of 3 skinned vertices"), std::string::npos) << character.warnings[1];

    // If only a second set has weights, the joints of the first have no effect.
    attributes(b)["JOINTS_1"] = b.add<uint8_t>({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, "VEC4", kUint8);
    attributes(b)["WEIGHTS_1"] = b.add<float>({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, "VEC4", kFloat);
    EXPECT_EQ(loaded(b).meshes[0].primitives[0].influence_joints[16], 0);
}

TEST(Import, Indices) {
    const std::string place = "meshes[0].primitives[0].indices";
    GlbBuilder b = tiny_character();
    primitive(b).erase("indices");
    EXPECT_EQ(loaded(b).meshes[0].primitives[0].indices, (std::vector<uint32_t>{0, 1, 2}));
    primitive(b)["indices"] = b.add<uint8_t>({2, 1, 0, 1}, "SCALAR", kUint8);
    const Asset cut = loaded(b);
    EXPECT_EQ(cut.meshes[0].primitives[0].indices, (std::vector<uint32_t>{2, 1, 0}));
    EXPECT_TRUE(has_warning(cut, "last triangle is incomplete"));
    primitive(b)["indices"] = b.add<uint32_t>({0, 1, 3}, "SCALAR", kUint32);
    expect_refused(b, place, "index 3, but there are 3 vertices");
    primitive(b)["indices"] = b.add<uint16_t>({0, 1, 65535}, "SCALAR", kUint16);
    expect_refused(b, place, "primitive restart");
    primitive(b)["indices"] = kTimes;
    expect_refused(b, place, "must be SCALAR of unsigned integers, but is SCALAR of floats");
    primitive(b)["indices"] = 70;
    expect_refused(b, place, "index 70");
}

TEST(Import, Modes) {
    GlbBuilder b = tiny_character();
    attributes(b) = {{"POSITION", b.add<float>(std::vector<float>(15), "VEC3", kFloat)}};
    b.json["nodes"][0].erase("skin");
    primitive(b).erase("indices");
    const auto with_mode = [&](int mode) {
        primitive(b)["mode"] = mode;
        return loaded(b).meshes[0].primitives[0].indices;
    };
    EXPECT_EQ(with_mode(4), (std::vector<uint32_t>{0, 1, 2}));
    EXPECT_EQ(with_mode(5), (std::vector<uint32_t>{0, 1, 2, 1, 3, 2, 2, 3, 4}));
    EXPECT_EQ(with_mode(6), (std::vector<uint32_t>{1, 2, 0, 2, 3, 0, 3, 4, 0}));
    for (int mode = 0; mode < 4; ++mode) EXPECT_TRUE(with_mode(mode).empty());
    EXPECT_TRUE(has_warning(loaded(b), "meshes[0].primitives[0]: points and lines are not drawn"));
    primitive(b)["mode"] = 99;
    expect_refused(b, "meshes[0].primitives[0].mode", "99 is unknown");
}

// Otherwise a file of a few kilobytes could become gigabytes of vertices or names.
TEST(Import, MeshesCountForEachNodeThatShowsThem) {
    constexpr uint64_t kVertices = 99'999;  // 32 bytes, influences of 24 and an index of 4 each
    GlbBuilder b = tiny_character();
    b.json["accessors"].push_back({{"componentType", kFloat}, {"count", kVertices}, {"type", "VEC3"}});
    attributes(b) = {{"POSITION", b.json["accessors"].size() - 1}};
    primitive(b).erase("indices");
    b.json.erase("scenes");
    b.json.erase("scene");
    for (uint64_t shown_bytes = kVertices * 60; shown_bytes + kVertices * 60 < gltf::kCompiledFloor_bytes;
         shown_bytes += kVertices * 60)
        b.json["nodes"].push_back({{"mesh", 0}});
    EXPECT_EQ(loaded(b).mesh_instances.size(), b.json["nodes"].size() - 2);
    b.json["nodes"].push_back({{"mesh", 0}});
    expect_refused(load(b), ErrorCode::kLimit, "meshes", "each counted for every node that shows it");

    b = tiny_character();
    b.json["nodes"][0]["name"] = std::string(size_t{1} << 20, 'n');
    const GltfJson one = primitive(b);
    for (int i = 1; i < 1023; ++i) b.json["meshes"][0]["primitives"].push_back(one);
    EXPECT_EQ(loaded(b).meshes[0].primitives.size(), 1023u);
    for (int i = 0; i < 2; ++i) b.json["meshes"][0]["primitives"].push_back(one);
    expect_refused(load(b), ErrorCode::kLimit, "meshes", "they take 1025 MiB once compiled");
}

}  // namespace
}  // namespace throng::test
