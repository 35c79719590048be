#include "tests/glb_builder.h"
#include "tests/files.h"
#include "tests/shared.h"
#include "tests/test_rig.h"

#include <throng/throng.h>

#include <draco/compression/encode.h>
#include <draco/mesh/mesh.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#include <gtest/gtest.h>
#include <meshoptimizer.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <numbers>
#include <set>
#include <tuple>

#include <sys/stat.h>

namespace throng::test {
namespace {

namespace fs = std::filesystem;

Result<Asset> load(const std::string& content, const std::string& name = "file.glb") {
    const TemporaryFolder folder;
    return load_asset(folder.write(name, content));
}
Result<Asset> load(const GlbBuilder& b) { return load(b.glb()); }

// Loads what must be valid.
Asset loaded(const GlbBuilder& b) {
    const Result<Asset> result = load(b);
    EXPECT_TRUE(result.ok()) << (result.ok() ? "" : result.error().text());
    return result.ok() ? *result : Asset{};
}

bool has_warning(const Asset& asset, const std::string& part) {
    return std::any_of(asset.warnings.begin(), asset.warnings.end(),
                       [&](const std::string& line) { return line.find(part) != line.npos; });
}

void expect_refused(const Result<Asset>& result, ErrorCode code, const std::string& place,
                    const std::string& part = "") {
    ASSERT_FALSE(result.ok()) << "loaded, but must be refused at " << place;
    const Error& error = result.error();
    EXPECT_EQ(int(error.code), int(code)) << error.text();
    EXPECT_EQ(error.place, place.empty() ? "file.glb" : "file.glb: " + place) << error.text();
    EXPECT_NE(error.message.find(part), std::string::npos) << error.text();
    EXPECT_EQ(error.text().find('\n'), std::string::npos) << error.text();
}
void expect_refused(const GlbBuilder& b, const std::string& place, const std::string& part = "") {
    expect_refused(load(b), ErrorCode::kInvalidFile, place, part);
}
void expect_limit(const GlbBuilder& b, const std::string& place) { expect_refused(load(b), ErrorCode::kLimit, place); }

GltfJson& primitive(GlbBuilder& b) { return b.json["meshes"][0]["primitives"][0]; }
GltfJson& attributes(GlbBuilder& b) { return primitive(b)["attributes"]; }
GltfJson& sampler(GlbBuilder& b) { return b.json["animations"][0]["samplers"][0]; }
GltfJson& channel(GlbBuilder& b) { return b.json["animations"][0]["channels"][0]; }

template <class T>
void overwrite(GlbBuilder& b, size_t accessor, size_t component, T value) {
    const size_t offset = b.json["bufferViews"][size_t(b.json["accessors"][accessor]["bufferView"])]["byteOffset"];
    std::memcpy(b.bin.data() + offset + component * sizeof(T), &value, sizeof(T));
}

// ---- The character that the other tests break ----

TEST(Import, TinyCharacter) {
    const Asset asset = loaded(tiny_character());
    EXPECT_EQ(asset.name, "file.glb");
    EXPECT_TRUE(asset.warnings.empty());
    ASSERT_EQ(asset.nodes.size(), 3u);
    EXPECT_EQ(asset.nodes[2].name, "tip");
    EXPECT_EQ(asset.nodes[2].parent, 1u);
    EXPECT_EQ(asset.nodes[0].parent, kNone);
    EXPECT_EQ(asset.nodes[2].parent_from_node.translation, (Vec3<double>{1, -2, -3}));
    ASSERT_EQ(asset.skins.size(), 1u);
    EXPECT_EQ(asset.skins[0].joints, (std::vector<uint32_t>{1, 2}));
    EXPECT_EQ(asset.skins[0].inverse_binds[1].row[0], (std::array<float, 4>{1, 0, 0, -1}));
    EXPECT_EQ(asset.skins[0].inverse_binds[1].row[2], (std::array<float, 4>{0, 0, 1, 3}));
    ASSERT_EQ(asset.clips.size(), 1u);
    EXPECT_EQ(asset.clips[0].name, "turn");
    EXPECT_EQ(asset.clips[0].duration_s, 1);
    ASSERT_EQ(asset.clips[0].tracks.size(), 1u);
    EXPECT_EQ(asset.clips[0].tracks[0].times_s, (std::vector<float>{0, 1}));
    EXPECT_EQ(asset.clips[0].tracks[0].values.size(), 8u);
    const AssetPrimitive& p = asset.meshes.at(0).primitives.at(0);
    EXPECT_EQ(p.positions[1], (Vec3<float>{1, 0, 0}));
    EXPECT_EQ(p.indices, (std::vector<uint32_t>{0, 1, 2}));
    EXPECT_EQ(p.influence_count, 4u);
    EXPECT_EQ(p.influence_joints[1], 1);
    EXPECT_EQ(p.influence_weights[1], 0.75f);
    ASSERT_EQ(asset.mesh_instances.size(), 1u);
    EXPECT_EQ(asset.mesh_instances[0].node, 0u);
    EXPECT_EQ(asset.mesh_instances[0].skin, 0u);
}

// ---- Files and URIs ----

TEST(Import, NoFile) {
    const auto missing = load_asset("/nowhere/fox.glb");
    ASSERT_FALSE(missing.ok());
    EXPECT_EQ(missing.error().code, ErrorCode::kFile);
    EXPECT_EQ(missing.error().text(), "fox.glb: no such file: /nowhere/fox.glb");
    const TemporaryFolder folder;
    const auto directory = load_asset(folder.path());
    ASSERT_FALSE(directory.ok());
    EXPECT_EQ(directory.error().message, "not a regular file: " + folder.path().string());
    // A pipe without a writer must not be waited for.
    const fs::path pipe = folder.path() / "pipe.glb";
    ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
    EXPECT_FALSE(load_asset(pipe).ok());
    EXPECT_FALSE(load_asset("/dev/zero").ok());
}

TEST(Import, DataUri) {
    const auto b = tiny_character();
    const auto result = load(b.gltf(), "file.gltf");
    ASSERT_TRUE(result.ok()) << result.error().text();
    EXPECT_EQ(result->meshes[0].primitives[0].positions[2], (Vec3<float>{0, 1, 0}));

    const std::string whole = base64(b.bin);
    const auto with_uri = [&](const std::string& uri) {
        GlbBuilder copy = b;
        copy.json["buffers"][0] = {{"byteLength", b.bin.size()}, {"uri", uri}};
        return load(copy.json.dump(), "file.glb");
    };
    std::string unpadded = whole, escaped;
    while (unpadded.back() == '=') unpadded.pop_back();
    for (const char c : whole) escaped += c == '=' ? "%3D" : c == '+' ? "%2B" : c == '/' ? "%2f" : std::string(1, c);
    EXPECT_TRUE(with_uri("data:;base64," + unpadded).ok());
    EXPECT_TRUE(with_uri("DATA:application/gltf-buffer;base64," + escaped).ok());
    const std::string place = "buffers[0].uri";
    expect_refused(with_uri("data:application/octet-stream;base64" + whole), ErrorCode::kInvalidFile, place,
                   "no comma");
    expect_refused(with_uri("data:;base64,!" + whole), ErrorCode::kInvalidFile, place, "not base64");
    expect_refused(with_uri("data:;base64,%4z" + whole), ErrorCode::kInvalidFile, place, "%4z");
    expect_refused(with_uri("data:;base64," + whole.substr(0, 40)), ErrorCode::kInvalidFile, "buffers[0]",
                   "but there are 30 bytes");
}

TEST(Import, SideFiles) {
    const TemporaryFolder outer;
    const auto b = tiny_character();
    const std::string content(reinterpret_cast<const char*>(b.bin.data()), b.bin.size());
    outer.write("folder/data/my buffer.bin", content);
    outer.write("secret.bin", content);
    fs::create_symlink(outer.path() / "secret.bin", outer.path() / "folder/link.bin");
    fs::create_symlink(outer.path(), outer.path() / "folder/up");
    const auto with_uri = [&](const std::string& uri) {
        GlbBuilder copy = b;
        copy.json["buffers"][0] = {{"byteLength", b.bin.size()}, {"uri", uri}};
        return load_asset(outer.write("folder/file.glb", copy.json.dump()));
    };
    EXPECT_TRUE(with_uri("data/my%20buffer.bin").ok());
    EXPECT_TRUE(with_uri("./data/my buffer.bin").ok());
    const std::string place = "buffers[0].uri";
    expect_refused(with_uri("missing.bin"), ErrorCode::kFile, place, "'missing.bin' cannot be found");
    expect_refused(with_uri("data"), ErrorCode::kFile, place, "not a regular file");
    expect_refused(with_uri("../secret.bin"), ErrorCode::kInvalidFile, place, "'..'");
    expect_refused(with_uri("%2e%2e/secret.bin"), ErrorCode::kInvalidFile, place, "'..'");
    expect_refused(with_uri("link.bin"), ErrorCode::kInvalidFile, place, "leads out");
    expect_refused(with_uri("up/secret.bin"), ErrorCode::kInvalidFile, place, "leads out");
    expect_refused(with_uri("/dev/zero"), ErrorCode::kInvalidFile, place, "absolute");
    expect_refused(with_uri("%2fdev/zero"), ErrorCode::kInvalidFile, place, "absolute");
    expect_refused(with_uri("file:///dev/zero"), ErrorCode::kInvalidFile, place, "not a relative path");
    expect_refused(with_uri("http://localhost/x.bin"), ErrorCode::kInvalidFile, place, "not a relative path");
    expect_refused(with_uri("a%zz.bin"), ErrorCode::kInvalidFile, place, "percent");
    expect_refused(with_uri("a%00.bin"), ErrorCode::kInvalidFile, place, "not a file name");
    expect_refused(with_uri(""), ErrorCode::kInvalidFile, place, "not a file name");
}

TEST(Import, GlbChunks) {
    const std::string good = tiny_character().glb();
    const auto with_word = [&](size_t offset, uint32_t word) {
        std::string copy = good;
        std::memcpy(copy.data() + offset, &word, 4);
        return load(copy);
    };
    expect_refused(load(""), ErrorCode::kInvalidFile, "", "empty");
    expect_refused(load("hello"), ErrorCode::kInvalidFile, "", "neither");
    expect_refused(load("null"), ErrorCode::kInvalidFile, "", "neither");
    expect_refused(with_word(4, 1), ErrorCode::kUnsupported, "", "glTF 1.0");
    expect_refused(with_word(4, 3), ErrorCode::kUnsupported, "", "GLB version 3");
    expect_refused(with_word(8, 0xFFFFFFFF), ErrorCode::kInvalidFile, "", "length is 4294967295");
    expect_refused(with_word(8, 20), ErrorCode::kInvalidFile, "", "GLB chunk 0");
    expect_refused(with_word(12, 0xFFFFFFFF), ErrorCode::kInvalidFile, "", "GLB chunk 0");
    expect_refused(with_word(16, 0x004E4942), ErrorCode::kInvalidFile, "", "must be JSON");
    for (size_t size = 0; size < good.size(); size += size < 40 ? 1 : 37)
        EXPECT_FALSE(load(good.substr(0, size)).ok()) << size;
    const auto longer = load(good + "more");
    ASSERT_TRUE(longer.ok());
    EXPECT_TRUE(has_warning(*longer, "after the stated length"));

    GlbBuilder short_bin = tiny_character();
    short_bin.json["buffers"][0]["byteLength"] = short_bin.bin.size() + 100;
    expect_refused(short_bin, "buffers[0]", "byteLength");
}

TEST(Import, JsonIsBounded) {
    expect_refused(load("{\"asset\":" + std::string(200'000, '[')), ErrorCode::kLimit, "",
                   "nested deeper than the limit of 64");
    expect_refused(load("{\"asset\": {\"version\": nan}}"), ErrorCode::kInvalidFile, "", "JSON cannot be read");
    expect_refused(load("{\"a\":\"\n\x85\xFF\"}"), ErrorCode::kInvalidFile, "", "JSON cannot be read");
    expect_refused(load("{}"), ErrorCode::kInvalidFile, "asset", "missing");
    // 40 MB of empty objects would take gigabytes.
    std::string many = "{\"asset\":{\"version\":\"2.0\"},\"nodes\":[{}";
    for (int i = 0; i < 13'000'000; ++i) many += ",{}";
    expect_refused(load(many + "]}"), ErrorCode::kLimit, "", "384 MiB");
    // One line, whatever the file says, and not a long one.
    GlbBuilder b = tiny_character();
    sampler(b)["interpolation"] = "a\nb\xE2\x80\xA8" + std::string(10'000, 'x');
    const auto result = load(b);
    ASSERT_FALSE(result.ok());
    EXPECT_LT(result.error().text().size(), 200u);
    EXPECT_EQ(result.error().text().find_first_of("\n\xE2"), std::string::npos);
}

TEST(Import, Versions) {
    const auto with = [](const GltfJson& asset) {
        GlbBuilder b = tiny_character();
        b.json["asset"] = asset;
        return load(b);
    };
    EXPECT_TRUE(with({{"version", "2.1"}}).ok());
    EXPECT_TRUE(with({{"version", "2.0"}, {"minVersion", "2.0"}}).ok());
    expect_refused(with({{"version", "1.0"}}), ErrorCode::kUnsupported, "asset.version", "glTF 1.0");
    expect_refused(with({{"version", "3.0"}}), ErrorCode::kUnsupported, "asset.version", "glTF 3.0");
    expect_refused(with({{"version", "2.1"}, {"minVersion", "2.1"}}), ErrorCode::kUnsupported, "asset.minVersion");
    expect_refused(with({{"version", 1}}), ErrorCode::kUnsupported, "asset.version", "glTF 1.0");
    expect_refused(with({{"version", 2}}), ErrorCode::kInvalidFile, "asset.version", "must be a string");
    expect_refused(with({{"version", "two"}}), ErrorCode::kInvalidFile, "asset.version", "not a version");
    expect_refused(with(GltfJson::array()), ErrorCode::kInvalidFile, "asset", "must be an object");
}

TEST(Import, Extensions) {
    GlbBuilder b = tiny_character();
    b.json["extensionsUsed"] = {"ANY_thing", "KHR_materials_unlit"};
    b.json["extensionsRequired"] = {"KHR_materials_unlit", "KHR_lights_punctual"};
    b.json["extensionsUsed"].push_back("KHR_materials_sheen");
    b.json["extensionsUsed"].push_back("KHR_materials_ior");
    EXPECT_EQ(loaded(b).warnings, (std::vector<std::string>{
                                      "file.glb: extensionsUsed: KHR_materials_unlit, KHR_materials_sheen: not drawn, "
                                      "but for what else the materials say"}));
    b.json["extensionsRequired"] = {"KHR_materials_unlit", "EXT_mesh_gpu_instancing"};
    expect_refused(load(b), ErrorCode::kUnsupported, "extensionsRequired[1]", "EXT_mesh_gpu_instancing");
}

// Cameras, lights, extras and the like are not looked at.
TEST(Import, UnneededPartsMayBeBroken) {
    GlbBuilder b = tiny_character();
    b.json["cameras"] = {1, "two", {{"type", "perspective"}}};
    b.json["nodes"][0]["camera"] = 99;
    b.json["extras"] = {{"a", nullptr}};
    b.json["samplers"] = 5;
    b.json["accessors"][kPosition]["min"] = "wrong";
    b.json["materials"] = {{{"extensions", {{"KHR_materials_sheen", "soft"}}}}};
    b.json["nodes"][1]["name"] = 5;
    b.json["accessors"].push_back({{"bufferView", 1234}});  // not used
    const Asset asset = loaded(b);
    EXPECT_TRUE(has_warning(asset, "nodes[1].name"));
    EXPECT_EQ(asset.warnings.size(), 1u);
}

// ---- Repairs of meshes and accessors ----

TEST(Import, NormalsThatAreMissingAreMade) {
    GlbBuilder b = tiny_character();
    attributes(b).erase("NORMAL");
    Asset asset = loaded(b);
    EXPECT_TRUE(has_warning(asset, "meshes[0].primitives[0]: 3 of 3 vertices have no normal")) << asset.warnings[0];
    EXPECT_EQ(asset.meshes[0].primitives[0].normals, (std::vector<Vec3<float>>(3, {0, 0, 1})));

    b = tiny_character();
    overwrite(b, kNormals, 3, 1.0f);  // of the second, which looks along x
    overwrite(b, kNormals, 5, 0.0f);
    overwrite(b, kNormals, 8, 0.0f);  // of the third
    asset = loaded(b);
    EXPECT_TRUE(has_warning(asset, "1 of 3 vertices have no normal"));
    EXPECT_EQ(asset.meshes[0].primitives[0].normals, (std::vector<Vec3<float>>{{0, 0, 1}, {1, 0, 0}, {0, 0, 1}}));

    overwrite(b, kPosition, 3, 0.0f);  // a triangle of no area: nobody knows
    asset = loaded(b);
    EXPECT_EQ(asset.meshes[0].primitives[0].normals[2], (Vec3<float>{}));
    EXPECT_TRUE(compile_character(asset));
}

// A tenth of the elements may be missing.
TEST(Import, AccessorsALittleTooLongAreReadAsFarAsTheyGo) {
    const auto with_colors = [](size_t count, size_t there) {
        GlbBuilder b = tiny_character();
        GltfJson& of = attributes(b);
        of.erase("JOINTS_0");
        of.erase("WEIGHTS_0");
        b.json["nodes"][0].erase("skin");
        of["POSITION"] = b.add(std::vector<float>(3 * count, 1), "VEC3", kFloat);
        of["NORMAL"] = b.add(std::vector<float>(3 * count, 1), "VEC3", kFloat);
        of["COLOR_0"] = b.add(std::vector<float>(4 * there, 0.5f), "VEC4", kFloat);
        b.json["accessors"].back()["count"] = count;
        return b;
    };
    const Asset asset = loaded(with_colors(20, 18));
    EXPECT_TRUE(has_warning(asset, "accessors[10]: 2 of 20 elements lie beyond its buffer view: they are 0"));
    EXPECT_EQ(asset.warnings.size(), 1u);
    const auto& colors = asset.meshes[0].primitives[0].colors;
    ASSERT_EQ(colors.size(), 20u);
    for (size_t v = 0; v < colors.size(); ++v) EXPECT_EQ(colors[v][0], v < 18 ? 0.5f : 0) << v;
    expect_refused(with_colors(20, 17), "accessors[10]", "a tenth of them may be missing");
    expect_refused(with_colors(20, 0), "accessors[10]", "do not fit");
    GlbBuilder many = with_colors(20, 18);
    many.json["accessors"].back()["count"] = 4'000'000'000u;
    EXPECT_FALSE(load(many));
}

// ---- Nodes and scenes ----

TEST(Import, NodeMatrix) {
    // Rotation by 120° about (1, 1, 1), scale (2, 3, -4): columns are y·2, z·3, x·-4.
    GlbBuilder b = tiny_character();
    b.json["nodes"][1]["matrix"] = {0, 2, 0, 0, 0, 0, 3, 0, -4, 0, 0, 0, 5, 6, 7, 1};
    const Asset asset = loaded(b);
    EXPECT_TRUE(asset.warnings.empty());
    const Trs<double>& t = asset.nodes[1].parent_from_node;
    EXPECT_EQ(t.translation, (Vec3<double>{5, 6, 7}));
    EXPECT_EQ(t.scale, (Vec3<double>{-2, 3, 4}));  // the mirror goes to x
    const AffineT<double> m = to_affine(t);
    const double expected[3][3] = {{0, 0, -4}, {2, 0, 0}, {0, 3, 0}};
    for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(m.row[size_t(r)][size_t(c)], expected[r][c], 1e-12);

    // All quadrants of the conversion to a quaternion.
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
    // Flat matrices keep a unit rotation.
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
    b.json["nodes"][2]["children"] = {0.0};  // an integer too
    EXPECT_EQ(loaded(b).nodes[0].parent, 2u);
    b.json["nodes"] = {7};
    expect_refused(b, "nodes[0]", "must be an object");
}

TEST(Import, DeepChain) {
    GlbBuilder b = tiny_character();
    constexpr uint32_t kDepth = 200'000;
    for (uint32_t i = 3; i < kDepth; ++i) b.json["nodes"].push_back({{"children", {i + 1}}});
    b.json["nodes"].push_back({{"mesh", 0}});
    b.json["nodes"][2]["children"] = {3};
    const Asset asset = loaded(b);
    ASSERT_EQ(asset.mesh_instances.size(), 2u);
    EXPECT_EQ(asset.mesh_instances[1].node, kDepth);
    b.json["nodes"].back()["children"] = {1};
    expect_refused(b, "nodes[1]", "is its own ancestor");
}

TEST(Import, Scenes) {
    GlbBuilder b = tiny_character();
    b.json["nodes"][2]["mesh"] = 0;            // without skin: follows node 2 rigidly
    b.json["nodes"].push_back({{"mesh", 0}});  // in no scene
    b.json["nodes"].push_back({{"skin", 0}});  // no mesh
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
    EXPECT_TRUE(has_warning(asset, "scenes[0].nodes[0]: is not a root"));
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

// ---- Skins ----

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
    overwrite(b, kInverseBinds, 19, kNan);  // the fourth row is not used
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

// ---- Clips ----

TEST(Import, Interpolations) {
    GlbBuilder b = tiny_character();
    EXPECT_EQ(loaded(b).clips[0].tracks[0].interpolation, Interpolation::kLinear);
    sampler(b)["interpolation"] = "STEP";
    EXPECT_EQ(loaded(b).clips[0].tracks[0].interpolation, Interpolation::kStep);
    sampler(b)["interpolation"] = "CUBICSPLINE";
    expect_refused(b, "animations[0].samplers[0].output", "has 2 values, but must have 6, for 2 key times");
    sampler(b)["output"] = b.add<float>({0, 0, 0, 0, 0, 0, 0, 1, 9, 9, 9, 9, 8, 8, 8, 8, 0, 0, 1, 0, 0, 0, 0, 0},
                                        "VEC4", kFloat);
    const Asset asset = loaded(b);
    EXPECT_TRUE(asset.warnings.empty());  // a tangent of length zero is no fault
    EXPECT_EQ(asset.clips[0].tracks[0].interpolation, Interpolation::kCubicSpline);
    EXPECT_EQ(asset.clips[0].tracks[0].values.size(), 24u);
    sampler(b)["interpolation"] = "BEZIER";
    expect_refused(b, "animations[0].samplers[0].interpolation", "'BEZIER' is unknown");
}

TEST(Import, NormalisedRotations) {
    for (const int type : {kInt8, kInt16, kUint8, kUint16}) {
        GlbBuilder b = tiny_character();
        if (type == kInt8) sampler(b)["output"] = b.add<int8_t>({0, 0, 0, 127, -128, 0, 0, 0}, "VEC4", type);
        if (type == kInt16) sampler(b)["output"] = b.add<int16_t>({0, 0, 0, 32767, -32768, 0, 0, 0}, "VEC4", type);
        if (type == kUint8) sampler(b)["output"] = b.add<uint8_t>({0, 0, 0, 255, 255, 0, 0, 0}, "VEC4", type);
        if (type == kUint16) sampler(b)["output"] = b.add<uint16_t>({0, 0, 0, 65535, 65535, 0, 0, 0}, "VEC4", type);
        expect_refused(b, "animations[0].samplers[0].output", "must be floats or normalised integers");
        b.json["accessors"].back()["normalized"] = true;
        const float one = type == kInt8 || type == kInt16 ? -1.0f : 1.0f;
        EXPECT_EQ(loaded(b).clips[0].tracks[0].values, (std::vector<float>{0, 0, 0, 1, one, 0, 0, 0}));
    }
}

TEST(Import, KeyTimes) {
    const std::string input = "animations[0].samplers[0].input";
    GlbBuilder b = tiny_character();
    const auto with_times = [&](float first, float second) {
        GlbBuilder copy = b;
        overwrite(copy, kTimes, 0, first);
        overwrite(copy, kTimes, 1, second);
        return copy;
    };
    expect_refused(with_times(0, kNan), input, "the time of key 1 is not finite");
    expect_refused(with_times(0, kInfinity), input, "not finite");
    expect_refused(with_times(-1, 0), input, "the time of key 0 is negative");
    EXPECT_EQ(loaded(with_times(2, 3)).clips[0].duration_s, 3);
    b.json["accessors"][kTimes]["type"] = "VEC2";
    b.json["accessors"][kTimes]["count"] = 1;
    expect_refused(b, input, "must be SCALAR of floats");
    b = tiny_character();
    b.json["accessors"][kTimes]["componentType"] = kUint32;
    expect_refused(b, input, "must be SCALAR of floats");
    b = tiny_character();
    b.json["accessors"][kTimes]["count"] = b.json["accessors"][kRotations]["count"] = 0;
    const Asset none = loaded(b);
    EXPECT_TRUE(none.clips[0].tracks.empty());
    EXPECT_TRUE(has_warning(none, "animations[0].channels[0]: has no keys"));
}

// A clip of one translation with such keys: x is the number of the key, from 1 on.
GlbBuilder with_keys(const std::vector<float>& times_s, const char* interpolation = "LINEAR") {
    GlbBuilder b = tiny_character();
    std::vector<float> values;
    const bool cubic = interpolation == std::string("CUBICSPLINE");
    for (size_t key = 0; key < times_s.size(); ++key) {
        const float x = float(key + 1);
        if (cubic) values.insert(values.end(), {x / 10, 0, 0});
        values.insert(values.end(), {x, 0, 0});
        if (cubic) values.insert(values.end(), {x / 100, 0, 0});
    }
    sampler(b)["input"] = b.add(times_s, "SCALAR", kFloat);
    sampler(b)["output"] = b.add(values, "VEC3", kFloat);
    sampler(b)["interpolation"] = interpolation;
    channel(b)["target"]["path"] = "translation";
    return b;
}

TEST(Import, KeyTimesThatGoBackAreSorted) {
    const std::string input = "animations[0].samplers[0].input: ";
    const auto expect_keys = [&](const GlbBuilder& b, const std::vector<float>& times_s, const std::vector<float>& xs) {
        const Asset asset = loaded(b);
        const AssetTrack& track = asset.clips.at(0).tracks.at(0);
        EXPECT_EQ(track.times_s, times_s);
        std::vector<float> got;
        for (size_t i = 0; i < track.values.size(); i += 3) got.push_back(track.values[i]);
        EXPECT_EQ(got, xs);
        return asset;
    };
    const auto before = [](float time_s) { return std::nextafter(time_s, 0.0f); };

    Asset asset = expect_keys(with_keys({0, 2, 1, 3}), {0, 1, 2, 3}, {1, 3, 2, 4});
    EXPECT_EQ(asset.warnings.size(), 1u);
    EXPECT_TRUE(has_warning(asset, input + "1 of the clip's 4 keys are earlier than the key before them"));
    EXPECT_EQ(asset.clips[0].duration_s, 3);
    asset = expect_keys(with_keys({4, 3, 2, 1}), {1, 2, 3, 4}, {4, 3, 2, 1});
    EXPECT_TRUE(has_warning(asset, input + "3 of the clip's 4 keys are earlier"));
    EXPECT_EQ(asset.clips[0].duration_s, 4);
    expect_keys(with_keys({2, 1}, "STEP"), {1, 2}, {2, 1});
    expect_keys(with_keys({2, 1}, "CUBICSPLINE"), {1, 2}, {0.2f, 2, 0.02f, 0.1f, 1, 0.01f});
    expect_keys(with_keys({5}), {5}, {1});

    // At one time the value jumps: the interval before ends at the first key, the interval behind begins at the last.
    asset = expect_keys(with_keys({0, 0.5f, 0.5f, 0.5f, 1}), {0, before(0.5f), 0.5f, 1}, {1, 2, 4, 5});
    EXPECT_EQ(asset.warnings.size(), 1u);
    EXPECT_TRUE(has_warning(asset, input + "2 of the clip's 5 keys have the time of another one"));
    asset = expect_keys(with_keys({1, 0.5f, 1, 0.5f}), {before(0.5f), 0.5f, before(1.0f), 1}, {2, 4, 1, 3});
    EXPECT_TRUE(has_warning(asset, input + "2 of the clip's 4 keys are earlier"));
    EXPECT_TRUE(has_warning(asset, input + "2 of the clip's 4 keys have the time"));
    expect_keys(with_keys({1, 1, 2}, "CUBICSPLINE"), {before(1.0f), 1, 2},
                {0.1f, 1, 0.01f, 0.2f, 2, 0.02f, 0.3f, 3, 0.03f});
    // The last one alone: steps, at 0, where floats have no time between, and where the difference is no normal float.
    expect_keys(with_keys({0, 1, 1, 2}, "STEP"), {0, 1, 2}, {1, 3, 4});
    expect_keys(with_keys({0, 0, 0}), {0}, {3});
    expect_keys(with_keys({before(1.0f), 1, 1}), {before(1.0f), 1}, {1, 3});
    expect_keys(with_keys({1e-39f, 1e-39f}), {1e-39f}, {2});
    expect_keys(with_keys({1e-33f, 1e-33f}), {1e-33f}, {2});
}

TEST(Import, MendedKeysAreOneWarningAClip) {
    GlbBuilder b = with_keys({0, 2, 1, 1});
    GltfJson& clip = b.json["animations"][0];
    clip["channels"].push_back(channel(b));  // uses the sampler again
    clip["channels"][1]["target"]["node"] = 1;
    clip["channels"].push_back(channel(b));
    clip["channels"][2]["target"]["path"] = "scale";
    clip["channels"][2]["sampler"] = 1;
    clip["samplers"].push_back(sampler(b));
    const Asset asset = loaded(b);
    EXPECT_EQ(asset.warnings.size(), 2u);
    const std::string place = "animations[0].samplers[0].input: ";
    EXPECT_TRUE(has_warning(asset, place + "2 of the clip's 8 keys are earlier"));
    EXPECT_TRUE(has_warning(asset, place + "2 of the clip's 8 keys have the time of another"));
    EXPECT_TRUE(has_warning(loaded(with_keys({0, 3, 2, 1})), place + "2 of the clip's 4 keys are earlier"));
}

// What is mended plays: as three.js plays keys at one time, and keys that go back as if they stood in order.
TEST(Import, MendedKeysPlay) {
    const auto tip_x = [](const GlbBuilder& b, double time_s) {
        const Character character = *compile_character(loaded(b));
        const auto pose = reference_pose(character, {.first = {.clip = 0, .time_s = time_s, .loop = false}});
        const auto& names = character.rig.names;
        const auto tip = std::find(names.begin(), names.end(), "tip") - names.begin();
        return pose->model_from_joint.at(size_t(tip)).row[0][3];
    };
    constexpr double kBound = 1e-3;  // of packed clips
    const GlbBuilder back = with_keys({0, 2, 1, 3});
    EXPECT_NEAR(tip_x(back, 0.5), 2, kBound);
    EXPECT_NEAR(tip_x(back, 1.5), 2.5, kBound);
    EXPECT_NEAR(tip_x(back, 2.5), 3, kBound);
    const GlbBuilder jump = with_keys({0, 1, 1, 2});
    EXPECT_NEAR(tip_x(jump, 0.5), 1.5, kBound);
    EXPECT_NEAR(tip_x(jump, 0.999), 1.999, kBound);
    EXPECT_NEAR(tip_x(jump, 1), 3, kBound);
    EXPECT_NEAR(tip_x(jump, 1.5), 3.5, kBound);
    EXPECT_NEAR(tip_x(with_keys({1, 1, 1}), 0.5), 1, kBound);
    EXPECT_NEAR(tip_x(with_keys({1, 1, 1}), 1), 3, kBound);
    // Tangents of 0.03 and 0.2 per second where it goes from the third to the second key.
    const double middle = (3 + 2) / 2.0 + (0.03 - 0.2) / 8;
    EXPECT_NEAR(tip_x(with_keys({0, 2, 1, 3}, "CUBICSPLINE"), 1.5), middle, kBound);
}

TEST(Import, KeyValues) {
    const std::string output = "animations[0].samplers[0].output";
    GlbBuilder b = tiny_character();
    overwrite(b, kRotations, 5, kInfinity);
    expect_refused(b, output, "the value of key 1 is not finite");
    b = tiny_character();
    overwrite(b, kRotations, 3, 0.0f);
    EXPECT_TRUE(has_warning(loaded(b), output + ": has a quaternion of length zero"));
    b = tiny_character();
    channel(b)["target"]["path"] = "scale";
    expect_refused(b, output, "must be VEC3, but is VEC4");
    b = tiny_character();
    b.json["accessors"][kRotations]["count"] = 1;
    expect_refused(b, output, "has 1 values, but must have 2");
}

TEST(Import, Channels) {
    GlbBuilder b = tiny_character();
    b.json["animations"][0]["channels"].push_back(channel(b));
    b.json["animations"][0]["channels"][1]["sampler"] = 1;
    GltfJson second = sampler(b);
    second["interpolation"] = "STEP";
    b.json["animations"][0]["samplers"].push_back(second);
    Asset asset = loaded(b);
    ASSERT_EQ(asset.clips[0].tracks.size(), 1u);
    EXPECT_EQ(asset.clips[0].tracks[0].interpolation, Interpolation::kStep);  // the last wins
    EXPECT_TRUE(has_warning(asset, "animations[0].channels[1]: animates what another"));

    b = tiny_character();
    channel(b)["target"].erase("node");
    asset = loaded(b);
    EXPECT_TRUE(asset.clips[0].tracks.empty());
    EXPECT_TRUE(has_warning(asset, "animations[0]: 1 of 1 channels have no target node"));
    channel(b)["target"] = {{"path", "pointer"},
                            {"extensions", {{"KHR_animation_pointer", {{"pointer", "/nodes/0"}}}}}};
    EXPECT_TRUE(has_warning(loaded(b), "KHR_animation_pointer"));
    b = tiny_character();
    channel(b)["target"]["path"] = "colour";
    EXPECT_TRUE(has_warning(loaded(b), "'colour' is unknown"));

    // Weights of a node without morph targets are ignored, and count for the duration.
    b = tiny_character();
    b.json["animations"][0]["samplers"].push_back(
        {{"input", b.add<float>({0, 2.5f}, "SCALAR", kFloat)}, {"output", kTimes}});
    b.json["animations"][0]["channels"].push_back({{"sampler", 1}, {"target", {{"node", 0}, {"path", "weights"}}}});
    asset = loaded(b);
    EXPECT_TRUE(asset.clips[0].morph_tracks.empty());
    EXPECT_TRUE(has_warning(asset, "animations[0].channels[1]: its node has no morph targets"));
    EXPECT_EQ(asset.clips[0].duration_s, 2.5);

    b = tiny_character();
    channel(b)["target"]["node"] = 3;
    expect_refused(b, "animations[0].channels[0].target.node", "index 3, but nodes has 3 entries");
    b = tiny_character();
    channel(b)["sampler"] = 7;
    expect_refused(b, "animations[0].channels[0].sampler", "index 7, but samplers has 1 entry");
    b = tiny_character();
    sampler(b)["input"] = 70;
    expect_refused(b, "animations[0].samplers[0].input", "index 70, but accessors has 8 entries");
    b = tiny_character();
    b.json["animations"][0]["channels"] = GltfJson::array();
    EXPECT_TRUE(has_warning(loaded(b), "animations[0]: has no channels"));
}

TEST(Import, ManyClips) {
    GlbBuilder b = tiny_character();
    const GltfJson clip = b.json["animations"][0];
    for (int i = 0; i < 20'000; ++i) b.json["animations"].push_back(clip);
    const auto start = std::chrono::steady_clock::now();
    EXPECT_EQ(loaded(b).clips.size(), 20'001u);
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(5));
}

// ---- Accessors ----

TEST(Import, AccessorBounds) {
    const auto with = [](const char* key, const GltfJson& value) {
        GlbBuilder b = tiny_character();
        b.json["accessors"][kPosition][key] = value;
        return b;
    };
    const std::string place = "accessors[0]";
    expect_refused(with("count", 4), place, "4 elements of 12 bytes from byte 0 do not fit");
    expect_refused(with("count", 2), "meshes[0].primitives[0].attributes.NORMAL", "has 3 elements, but POSITION has 2");
    expect_refused(with("byteOffset", 1), place, "do not fit");
    expect_refused(with("byteOffset", 1ull << 52), place, "do not fit");
    expect_refused(with("byteOffset", -4), place + ".byteOffset", "-4");
    expect_refused(with("byteOffset", 1ull << 60), place + ".byteOffset", "non-negative integer");
    expect_refused(with("bufferView", 99), place + ".bufferView", "index 99");
    expect_refused(with("componentType", 5124), place, "componentType 5124 is unknown");
    expect_refused(with("type", "VEC9"), place, "type 'VEC9' is unknown");
    expect_refused(with("type", 3), place + ".type", "must be a string");
    expect_refused(with("count", 3.5), place + ".count", "3.5");
    expect_limit(with("count", 4294967295u), place);

    const auto with_view = [](const char* key, const GltfJson& value) {
        GlbBuilder b = tiny_character();
        b.json["bufferViews"][0][key] = value;
        return b;
    };
    expect_refused(with_view("byteLength", 35), place, "do not fit into its buffer view of 35 bytes");
    expect_refused(with_view("byteLength", 1 << 20), "bufferViews[0]", "ends at byte 1048576");
    expect_refused(with_view("byteOffset", 4294967280u), "bufferViews[0]", "ends at byte");
    expect_refused(with_view("byteOffset", (1ull << 53) - 1), "bufferViews[0]", "ends at byte");
    expect_refused(with_view("buffer", 1), "bufferViews[0].buffer", "index 1, but buffers has 1 entry");
    expect_refused(with_view("byteStride", 4), place, "byteStride of its buffer view is 4");
    expect_refused(with_view("byteStride", 1ull << 40), place, "byteStride");
}

TEST(Import, Strides) {
    GlbBuilder b = tiny_character();
    const std::vector<float> values{9, 1, 2, 3, 9, 4, 5, 6, 9, 7, 8, 9};
    const size_t view = b.add_view(std::as_bytes(std::span(values)));
    b.json["bufferViews"][view]["byteStride"] = 16;
    const size_t accessor = b.add_accessor(view, 9, "VEC3", kFloat);
    b.json["accessors"][accessor]["byteOffset"] = 4;  // the last element ends with the view
    attributes(b)["POSITION"] = accessor;
    EXPECT_EQ(loaded(b).meshes[0].primitives[0].positions, (std::vector<Vec3<float>>{{1, 2, 3}, {4, 5, 6}, {7, 8, 9}}));
    b.json["accessors"][accessor]["byteOffset"] = 8;
    expect_refused(b, "accessors[8]", "do not fit");
}

TEST(Import, Sparse) {
    GlbBuilder b = tiny_character();
    const std::vector<uint16_t> indices{0, 2};
    const std::vector<float> values{5, 6, 7, 8, 9, 10};
    GltfJson& accessor = b.json["accessors"][kPosition];
    const size_t indices_view = b.add_view(std::as_bytes(std::span(indices))),
                 values_view = b.add_view(std::as_bytes(std::span(values)));
    accessor["sparse"] = {{"count", 2},
                          {"indices", {{"bufferView", indices_view}, {"componentType", kUint16}}},
                          {"values", {{"bufferView", values_view}}}};
    EXPECT_EQ(loaded(b).meshes[0].primitives[0].positions,
              (std::vector<Vec3<float>>{{5, 6, 7}, {1, 0, 0}, {8, 9, 10}}));
    accessor.erase("bufferView");  // zeros
    EXPECT_EQ(loaded(b).meshes[0].primitives[0].positions,
              (std::vector<Vec3<float>>{{5, 6, 7}, {0, 0, 0}, {8, 9, 10}}));
    const GltfJson good = accessor["sparse"];
    accessor["sparse"]["count"] = 4;
    expect_refused(b, "accessors[0].sparse", "count is 4, but the accessor has 3 elements");
    accessor["sparse"]["count"] = 3;
    expect_refused(b, "accessors[0].sparse.indices", "do not fit");
    accessor["sparse"] = good;
    accessor["sparse"]["indices"]["componentType"] = kFloat;
    expect_refused(b, "accessors[0].sparse.indices", "must be unsigned integers");
    accessor["sparse"] = good;
    accessor["sparse"]["values"]["bufferView"] = 99;
    expect_refused(b, "accessors[0].sparse.values.bufferView", "index 99");
    accessor["sparse"] = good;
    accessor["sparse"]["values"]["byteOffset"] = 4;
    expect_refused(b, "accessors[0].sparse.values", "do not fit");
    accessor["sparse"] = good;
    b.bin[size_t(b.json["bufferViews"][indices_view]["byteOffset"])] = std::byte(3);
    expect_refused(b, "accessors[0].sparse.indices", "index 3, but the accessor has 3 elements");
}

TEST(Import, AmplificationIsBounded) {
    // An accessor without data costs its file nothing.
    GlbBuilder b = tiny_character();
    b.json["accessors"].push_back({{"componentType", kFloat}, {"count", 400'000'000}, {"type", "VEC3"}});
    attributes(b) = {{"POSITION", 8}};
    expect_limit(b, "meshes[0].primitives[0].attributes.POSITION");
    b.json["accessors"][8]["sparse"] = {
        {"count", 0}, {"indices", {{"bufferView", 0}, {"componentType", kUint8}}}, {"values", {{"bufferView", 0}}}};
    expect_limit(b, "meshes[0].primitives[0].attributes.POSITION");
    // Nor do many primitives over one.
    b.json["accessors"][8] = {{"componentType", kFloat}, {"count", 1'000'000}, {"type", "VEC3"}};
    const GltfJson one = primitive(b);
    for (int i = 0; i < 1000; ++i) b.json["meshes"][0]["primitives"].push_back(one);
    const auto result = load(b);
    ASSERT_FALSE(result.ok());
    EXPECT_EQ(result.error().code, ErrorCode::kLimit);
}

// ---- Meshes ----

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
    EXPECT_EQ(p.normals[1], (Vec3<float>{0, 0, 1}));  // mended
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

TEST(Import, Influences) {
    const std::string place = "meshes[0].primitives[0].attributes";
    // Two sets, the second of normalised integers.
    GlbBuilder b = tiny_character();
    attributes(b)["JOINTS_1"] = b.add<uint16_t>({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, "VEC4", kUint16);
    attributes(b)["WEIGHTS_1"] = b.add<uint8_t>({255, 0, 0, 0, 51, 0, 0, 0, 0, 0, 0, 0}, "VEC4", kUint8);
    expect_refused(b, place + ".WEIGHTS_1", "unsigned 8-bit integers");
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
    overwrite<uint8_t>(b, kVertexJoints, 3, 200);  // of weight 0
    EXPECT_EQ(loaded(b).meshes[0].primitives[0].influence_joints[3], 0);
    overwrite<uint8_t>(b, kVertexJoints, 4, 2);
    expect_refused(b, place + ".JOINTS_0", "vertex 1 follows joint 2, but skins[0] has 2");
    b.json["nodes"][0].erase("skin");  // nobody uses the joints
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

    // None is left: each vertex follows its first joint, or the skin's first where that has no such joint.
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
    // The tip stands at (1, -2, -3); its inverse bind matrix moves by (-1, 2, 3).
    EXPECT_EQ(positions[1], (Vec3<double>{1, 0, 0}));
    EXPECT_EQ(positions[2], (Vec3<double>{0, 1, 0}));
    const auto turned = reference_pose(character, {.first = {.clip = 0, .time_s = 1, .loop = false}});
    const auto later = reference_positions(character, *turned);
    EXPECT_GT(length(later[1] - positions[1]), 1) << "follows joint 1, which turns";
    EXPECT_EQ(later[2], positions[2]) << "follows joint 0, which stands";
    ASSERT_EQ(character.warnings.size(), 2u);
    EXPECT_NE(character.warnings[1].find("3 of 3 skinned vertices"), std::string::npos) << character.warnings[1];

    // A second set has weight: the joints of the first mean nothing.
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

TEST(Import, MorphTargets) {
    GlbBuilder b = tiny_character();
    const std::array<float, 3> moved{7, 8, 9};
    const std::array<uint8_t, 1> which{1};
    const size_t view = b.add_view(std::as_bytes(std::span(moved))),
                 index = b.add_view(std::as_bytes(std::span(which)));
    b.json["accessors"].push_back({{"componentType", kFloat},
                                   {"count", 3},
                                   {"type", "VEC3"},
                                   {"sparse",
                                    {{"count", 1},
                                     {"indices", {{"bufferView", index}, {"componentType", kUint8}}},
                                     {"values", {{"bufferView", view}}}}}});
    const size_t sparse = b.json["accessors"].size() - 1,
                 positions = b.add<float>({1, 2, 3, 4, 5, 6, 7, 8, 9}, "VEC3", kFloat),
                 normals = b.add<float>({0, 0, 1, 0, 1, 0, 0, 0, 0}, "VEC3", kFloat);
    primitive(b)["targets"] = {
        {{"POSITION", positions}, {"NORMAL", normals}, {"TANGENT", 99}}, {{"POSITION", sparse}}, GltfJson::object()};
    b.json["meshes"].push_back(
        {{"primitives",
          {{{"attributes", {{"POSITION", kPosition}}},
            {"mode", 0},
            {"targets", {GltfJson::object(), GltfJson::object()}}},
           {{"attributes", {{"POSITION", kPosition}}}, {"targets", {{{"POSITION", sparse}}, GltfJson::object()}}}}}});
    b.json["nodes"].push_back({{"mesh", 1}, {"weights", {0.25, -2}}});
    b.json["nodes"].push_back({{"mesh", 0}});
    b.json["scenes"][0]["nodes"] = {0, 1, 3, 4};
    b.json["meshes"][0]["weights"] = {0.5, 0, 1};
    b.json["meshes"][0]["extras"] = {{"targetNames", {"smile", "blink", "nothing"}}};
    Asset asset = loaded(b);
    const AssetMesh& mesh = asset.meshes[0];
    EXPECT_EQ(asset.warnings.size(), 2u) << "of the points, and of normals that are missing";
    EXPECT_EQ(mesh.weights, (std::vector<float>{0.5f, 0, 1}));
    EXPECT_EQ(mesh.target_names, (std::vector<std::string>{"smile", "blink", "nothing"}));
    const std::vector<AssetMorphTarget>& targets = mesh.primitives[0].targets;
    ASSERT_EQ(targets.size(), 3u);
    EXPECT_EQ(targets[0].positions, (std::vector<Vec3<float>>{{1, 2, 3}, {4, 5, 6}, {7, 8, 9}}));
    EXPECT_EQ(targets[0].normals, (std::vector<Vec3<float>>{{0, 0, 1}, {0, 1, 0}, {0, 0, 0}}));
    EXPECT_EQ(targets[1].positions, (std::vector<Vec3<float>>{{0, 0, 0}, {7, 8, 9}, {0, 0, 0}}));
    EXPECT_TRUE(targets[1].normals.empty() && targets[2].positions.empty() && targets[2].normals.empty());
    EXPECT_EQ(asset.meshes[1].weights, (std::vector<float>{0, 0}));
    EXPECT_TRUE(asset.meshes[1].target_names.empty());
    EXPECT_TRUE(asset.meshes[1].primitives[0].targets.empty()) << "points";
    EXPECT_EQ(asset.meshes[1].primitives[1].targets.size(), 2u);
    ASSERT_EQ(asset.mesh_instances.size(), 3u);
    EXPECT_TRUE(asset.mesh_instances[0].weights.empty());
    EXPECT_EQ(asset.mesh_instances[1].weights, (std::vector<float>{0.25f, -2}));

    for (const GltfJson& names : {GltfJson(3), GltfJson({"one"}), GltfJson({"one", 2, "three"})}) {
        b.json["meshes"][0]["extras"] = {{"targetNames", names}};
        asset = loaded(b);
        EXPECT_TRUE(asset.meshes[0].target_names.empty());
        EXPECT_TRUE(has_warning(asset, "meshes[0].extras.targetNames: is not a name for each morph target"));
    }
    b.json["meshes"][0]["extras"] = 5;
    EXPECT_TRUE(loaded(b).meshes[0].target_names.empty());
}

TEST(Import, QuantisedMorphTargets) {
    GlbBuilder b = tiny_character();
    const size_t positions = b.add<int16_t>({1, 2, 3, -4, 5, 6, 7, 8, 32767}, "VEC3", kInt16),
                 normals = b.add<int8_t>({127, 0, 0, 0, -127, 0, 0, 0, 0}, "VEC3", kInt8);
    b.json["accessors"][normals]["normalized"] = true;
    primitive(b)["targets"] = {{{"POSITION", positions}, {"NORMAL", normals}}};
    const std::string place = "meshes[0].primitives[0].targets[0]";
    expect_refused(b, place + ".POSITION", "without KHR_mesh_quantization");
    b.json["extensionsUsed"] = b.json["extensionsRequired"] = {"KHR_mesh_quantization"};
    const AssetMorphTarget target = loaded(b).meshes[0].primitives[0].targets[0];
    EXPECT_EQ(target.positions[1], (Vec3<float>{-4, 5, 6}));
    EXPECT_EQ(target.normals[1], (Vec3<float>{0, -1, 0}));
    b.json["accessors"][normals]["normalized"] = false;
    expect_refused(b, place + ".NORMAL", "must not be");
    b.json["accessors"][normals]["normalized"] = true;
    b.json["accessors"][positions]["componentType"] = kUint16;
    expect_refused(b, place + ".POSITION", "must not be");
}

TEST(Import, BrokenMorphTargets) {
    GlbBuilder good = tiny_character();
    const size_t two = good.add<float>(std::vector<float>(6), "VEC3", kFloat),
                 flat = good.add<float>(std::vector<float>(6), "VEC2", kFloat),
                 infinite = good.add<float>({0, 0, 0, 0, kInfinity, 0, 0, 0, 0}, "VEC3", kFloat);
    primitive(good)["targets"] = {{{"POSITION", kPosition}}, GltfJson::object()};
    EXPECT_EQ(loaded(good).meshes[0].weights.size(), 2u);
    const std::string place = "meshes[0].primitives[0].targets";
    const auto refused = [&](const auto& breaks, const std::string& where, const std::string& part) {
        GlbBuilder b = good;
        breaks(b);
        expect_refused(b, where, part);
    };
    refused([](GlbBuilder& b) { primitive(b)["targets"] = 4; }, place, "must be an array");
    refused([](GlbBuilder& b) { primitive(b)["targets"][1] = 4; }, place + "[1]", "must be an object");
    refused([](GlbBuilder& b) { primitive(b)["targets"][0]["POSITION"] = 99; }, place + "[0].POSITION", "index 99");
    refused([](GlbBuilder& b) { primitive(b)["targets"][0]["NORMAL"] = -1; }, place + "[0].NORMAL", "");
    refused([&](GlbBuilder& b) { primitive(b)["targets"][0]["POSITION"] = two; }, place + "[0].POSITION",
            "has 2 elements, but POSITION has 3");
    refused([&](GlbBuilder& b) { primitive(b)["targets"][0]["POSITION"] = flat; }, place + "[0].POSITION",
            "must be VEC3, but is VEC2");
    refused([&](GlbBuilder& b) { primitive(b)["targets"][1]["NORMAL"] = infinite; }, place + "[1].NORMAL",
            "vertex 1 is not finite");
    refused([](GlbBuilder& b) { primitive(b)["targets"][1]["POSITION"] = kWeights; }, place + "[1].POSITION",
            "must be VEC3, but is VEC4");
    refused(
        [](GlbBuilder& b) {
            b.json["meshes"][0]["primitives"].push_back(primitive(b));
            b.json["meshes"][0]["primitives"][1]["targets"].erase(1);
        },
        "meshes[0].primitives[1].targets", "has 1 morph targets, but the first primitive has 2");
    refused(
        [](GlbBuilder& b) {
            b.json["meshes"][0]["weights"] = {1, 2, 3};
        },
        "meshes[0].weights", "has 3 numbers, but the mesh has 2 morph targets");
    refused(
        [](GlbBuilder& b) {
            b.json["meshes"][0]["weights"] = {1, "x"};
        },
        "meshes[0].weights[1]", "must be a number");
    refused([](GlbBuilder& b) { b.json["nodes"][0]["weights"] = {1}; }, "nodes[0].weights",
            "has 1 numbers, but the mesh has 2 morph targets");
    refused([](GlbBuilder& b) { b.json["nodes"][0]["weights"] = {0, 1e40}; }, "nodes[0].weights[1]", "");
    // Many targets over one accessor cost a file nothing.
    GlbBuilder b = tiny_character();
    b.json["accessors"].push_back({{"componentType", kFloat}, {"count", 100'000}, {"type", "VEC3"}});
    attributes(b) = {{"POSITION", 8}};
    for (int i = 0; i < 1000; ++i) primitive(b)["targets"].push_back({{"POSITION", 8}});
    const auto result = load(b);
    ASSERT_FALSE(result.ok());
    EXPECT_EQ(result.error().code, ErrorCode::kLimit);
}

TEST(Import, MorphWeightsOfClips) {
    GlbBuilder good = tiny_character();
    primitive(good)["targets"] = {{{"POSITION", kPosition}}, GltfJson::object()};
    const size_t times = good.add<float>({0.5f, 1, 1, 3}, "SCALAR", kFloat),
                 values = good.add<float>({1, 2, 3, 4, 5, 6, 7, 8}, "SCALAR", kFloat);
    good.json["animations"][0]["samplers"].push_back({{"input", times}, {"output", values}});
    good.json["animations"][0]["channels"].push_back({{"sampler", 1}, {"target", {{"node", 0}, {"path", "weights"}}}});
    const auto track = [](const GlbBuilder& b) {
        const Asset asset = loaded(b);
        EXPECT_EQ(asset.clips.at(0).morph_tracks.size(), 1u);
        return asset.clips[0].morph_tracks.empty() ? AssetMorphTrack{} : asset.clips[0].morph_tracks[0];
    };
    AssetMorphTrack got = track(good);
    EXPECT_EQ(got.node, 0u);
    EXPECT_EQ(got.interpolation, Interpolation::kLinear);
    const float before_1 = std::nextafter(1.0f, 0.0f);
    EXPECT_EQ(got.times_s, (std::vector<float>{0.5f, before_1, 1, 3}));
    EXPECT_EQ(got.values, (std::vector<float>{1, 2, 3, 4, 5, 6, 7, 8})) << "a jump between two keys at one time";
    EXPECT_EQ(loaded(good).clips[0].duration_s, 3);

    const auto weights_sampler = [](GlbBuilder& b) -> GltfJson& { return b.json["animations"][0]["samplers"][1]; };
    GlbBuilder b = good;
    overwrite(b, times, 0, 2.0f);
    EXPECT_EQ(track(b).times_s, (std::vector<float>{before_1, 1, 2, 3}));
    EXPECT_EQ(track(b).values, (std::vector<float>{3, 4, 5, 6, 1, 2, 7, 8})) << "sorted by time";
    b = good;
    weights_sampler(b)["interpolation"] = "STEP";
    EXPECT_EQ(track(b).interpolation, Interpolation::kStep);
    weights_sampler(b)["interpolation"] = "CUBICSPLINE";
    weights_sampler(b)["input"] = kTimes;
    weights_sampler(b)["output"] = b.add<float>({1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12}, "SCALAR", kFloat);
    EXPECT_EQ(track(b).values.size(), 12u);
    weights_sampler(b)["interpolation"] = "LINEAR";
    weights_sampler(b)["output"] = b.add<uint8_t>({0, 51, 255, 0}, "SCALAR", kUint8);
    b.json["accessors"].back()["normalized"] = true;
    EXPECT_EQ(track(b).values, (std::vector<float>{0, 0.2f, 1, 0}));
    b = good;
    b.json["animations"][0]["channels"].push_back(b.json["animations"][0]["channels"][1]);
    EXPECT_TRUE(
        has_warning(loaded(b), "animations[0].channels[2]: animates what another channel of the clip animates"));

    const std::string place = "animations[0].samplers[1]";
    const auto refused = [&](const auto& breaks, const std::string& where, const std::string& part) {
        GlbBuilder broken = good;
        breaks(broken);
        expect_refused(broken, where, part);
    };
    refused([&](GlbBuilder& f) { weights_sampler(f)["interpolation"] = "CUBICSPLINE"; }, place + ".output",
            "has 8 values, but must have 24, for 4 key times and 2 morph targets");
    refused([&](GlbBuilder& f) { weights_sampler(f)["output"] = kTimes; }, place + ".output",
            "has 2 values, but must have 8");
    refused([&](GlbBuilder& f) { weights_sampler(f)["output"] = kPosition; }, place + ".output",
            "must be SCALAR, but is VEC3");
    refused([&](GlbBuilder& f) { weights_sampler(f)["output"] = kIndices; }, place + ".output",
            "must be floats or normalised integers");
    refused([&](GlbBuilder& f) { weights_sampler(f)["input"] = kPosition; }, place + ".input",
            "must be SCALAR of floats");
    refused([&](GlbBuilder& f) { weights_sampler(f)["interpolation"] = "WIGGLE"; }, place + ".interpolation",
            "'WIGGLE' is unknown");
    refused([&](GlbBuilder& f) { overwrite<float>(f, values, 5, kNan); }, place + ".output",
            "the value of key 2 is not finite");
}

// ---- Materials ----

TEST(Import, Materials) {
    GlbBuilder b = tiny_character();
    const std::vector<std::byte> png{std::byte(1), std::byte(2), std::byte(3)};
    b.json["images"] = {{{"uri", "unused.png"}},
                        {{"bufferView", b.add_view(png)}, {"mimeType", "image/png"}, {"name", "skin"}}};
    b.json["textures"] = {{{"source", 1}}, {{"extensions", {{"KHR_texture_basisu", {{"source", 0}}}}}}};
    b.json["materials"] = {
        {{"name", "cloth"},
         {"alphaMode", "MASK"},
         {"alphaCutoff", 0.25},
         {"doubleSided", true},
         {"pbrMetallicRoughness",
          {{"baseColorFactor", {0.5, 0.25, 0, 1}},
           {"baseColorTexture", {{"index", 0}, {"extensions", {{"KHR_texture_transform", {{"scale", {2, 2}}}}}}}}}}},
        {{"alphaMode", "BLEND"}, {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 1}}}}}},
        {{"alphaMode", "GLASS"}, {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}},
        GltfJson::object()};
    const Asset asset = loaded(b);
    ASSERT_EQ(asset.materials.size(), 4u);
    EXPECT_EQ(asset.materials[0].name, "cloth");
    EXPECT_EQ(asset.materials[0].base_color, (std::array<float, 4>{0.5f, 0.25f, 0, 1}));
    EXPECT_EQ(asset.materials[0].alpha_mode, AlphaMode::kMask);
    EXPECT_EQ(asset.materials[0].alpha_cutoff, 0.25f);
    EXPECT_TRUE(asset.materials[0].double_sided);
    EXPECT_EQ(asset.materials[0].image, 0u);
    EXPECT_EQ(asset.materials[1].image, kNone);
    EXPECT_EQ(asset.materials[1].alpha_mode, AlphaMode::kBlend);
    EXPECT_EQ(asset.materials[2].image, 0u);  // read once
    EXPECT_EQ(asset.materials[2].alpha_mode, AlphaMode::kOpaque);
    EXPECT_EQ(asset.materials[3].image, kNone);
    ASSERT_EQ(asset.images.size(), 1u);
    EXPECT_EQ(asset.images[0].name, "skin");
    EXPECT_EQ(asset.images[0].encoded, png);
    EXPECT_TRUE(has_warning(asset, "textures[1]: is a KTX2 image (KHR_texture_basisu), which is not read"));
    EXPECT_TRUE(has_warning(asset, "materials[2].alphaMode: 'GLASS' is unknown"));

    EXPECT_EQ(asset.materials[0].metallic, 1);
    EXPECT_EQ(asset.materials[0].emissive, (std::array<float, 3>{}));

    b.json["textures"][0]["source"] = 2;
    expect_refused(b, "textures[0].source", "index 2, but images has 2 entries");
    b.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["index"] = 2;
    expect_refused(b, "materials[0].pbrMetallicRoughness.baseColorTexture.index", "index 2");
    b.json["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] = {1, 1, 1};
    expect_refused(b, "materials[0].pbrMetallicRoughness.baseColorFactor", "must have 4 numbers");
    b.json["materials"][0] = "red";
    expect_refused(b, "materials[0]", "must be an object");
}

TEST(Import, TexturesMayBeOfWebPAlone) {
    GlbBuilder b = tiny_character();
    const std::vector<std::byte> png(3, std::byte(1)), webp(5, std::byte(2));
    b.json["images"] = {{{"bufferView", b.add_view(png)}, {"mimeType", "image/png"}},
                        {{"bufferView", b.add_view(webp)}, {"mimeType", "image/webp"}}};
    const GltfJson of_webp{{"EXT_texture_webp", {{"source", 1}}}};
    b.json["textures"] = {{{"extensions", of_webp}}, {{"source", 0}, {"extensions", of_webp}}};
    for (const char* list : {"extensionsUsed", "extensionsRequired"}) b.json[list] = {"EXT_texture_webp"};
    b.json["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}},
                           {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 1}}}}}}};
    const Asset asset = loaded(b);
    EXPECT_TRUE(asset.warnings.empty());
    ASSERT_EQ(asset.images.size(), 1u);
    ASSERT_EQ(asset.materials[0].image, 0u);
    EXPECT_EQ(asset.images[0].encoded, webp);
    EXPECT_EQ(asset.materials[1].image, asset.materials[0].image) << "what stands beside it is for others";
    b.json["textures"][0]["extensions"]["EXT_texture_webp"]["source"] = 2;
    expect_refused(b, "textures[0].extensions.EXT_texture_webp.source", "index 2, but images has 2 entries");
}

TEST(Import, MaterialsHaveAllTexturesThatShareTheirCoordinates) {
    GlbBuilder b = tiny_character();
    const size_t view = b.add_view(std::vector<std::byte>(3));
    b.json["images"] = GltfJson::array();
    b.json["textures"] = GltfJson::array();
    for (size_t i = 0; i < 5; ++i) {
        b.json["images"].push_back({{"bufferView", view}, {"mimeType", "image/png"}, {"name", std::to_string(i)}});
        b.json["textures"].push_back({{"source", i}});
    }
    b.json["materials"] = {{{"pbrMetallicRoughness",
                             {{"metallicFactor", 0.25},
                              {"roughnessFactor", 0.75},
                              {"baseColorTexture", {{"index", 0}, {"texCoord", 1}}},
                              {"metallicRoughnessTexture", {{"index", 1}, {"texCoord", 1}}}}},
                            {"normalTexture", {{"index", 2}, {"texCoord", 1}, {"scale", 0.5}}},
                            {"occlusionTexture", {{"index", 3}, {"texCoord", 1}, {"strength", 0.125}}},
                            {"emissiveTexture", {{"index", 4}, {"texCoord", 1}}},
                            {"emissiveFactor", {1, 0.5, 0}},
                            {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 4}}}}}}};
    const auto name_of = [](const Asset& asset, uint32_t image) {
        return image == kNone ? "none" : asset.images.at(image).name;
    };
    const Asset asset = loaded(b);
    const AssetMaterial& material = asset.materials[0];
    EXPECT_EQ(std::tuple(material.metallic, material.roughness, material.normal_scale, material.occlusion_strength),
              std::tuple(0.25f, 0.75f, 0.5f, 0.125f));
    EXPECT_EQ(material.emissive, (std::array<float, 3>{4, 2, 0}));
    EXPECT_EQ(name_of(asset, material.image), "0");
    EXPECT_EQ(name_of(asset, material.metallic_roughness_image), "1");
    EXPECT_EQ(name_of(asset, material.normal_image), "2");
    EXPECT_EQ(name_of(asset, material.occlusion_image), "3");
    EXPECT_EQ(name_of(asset, material.emissive_image), "4");

    b.json["materials"][0]["normalTexture"].erase("texCoord");
    const Asset other_set = loaded(b);
    EXPECT_EQ(other_set.materials[0].normal_image, kNone);
    EXPECT_EQ(name_of(other_set, other_set.materials[0].emissive_image), "4");
    EXPECT_TRUE(has_warning(other_set, "materials[0].normalTexture: uses other texture coordinates"));
    b.json["textures"][0].erase("source");
    b.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["texCoord"] = 0;
    const Asset left_out = loaded(b);
    EXPECT_EQ(name_of(left_out, left_out.materials[0].metallic_roughness_image), "1")
        << "a texture without an image decides nothing";
    b.json["materials"][0]["normalTexture"]["index"] = 5;
    b.json["materials"][0]["normalTexture"]["texCoord"] = 1;
    expect_refused(b, "materials[0].normalTexture.index", "index 5");
}

// KHR_texture_transform: scaled, then turned, then moved.
TEST(Import, TextureCoordinatesAreThoseThatTheTextureIsLookedUpBy) {
    GlbBuilder b = tiny_character();
    attributes(b)["TEXCOORD_1"] = b.add<float>({0.25f, 0.5f, 1, 0, 0, 1}, "VEC2", kFloat);
    const size_t view = b.add_view(std::vector<std::byte>(3));
    b.json["images"] = {{{"bufferView", view}, {"mimeType", "image/png"}}};
    b.json["textures"] = {{{"source", 0}}};
    const auto texcoords = [&](const GltfJson& transform) {
        const GltfJson texture{{"index", 0}, {"extensions", {{"KHR_texture_transform", transform}}}};
        b.json["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", texture}}}, {"normalTexture", texture}}};
        b.json["meshes"][0]["primitives"][0]["material"] = 0;
        const Asset asset = loaded(b);
        EXPECT_TRUE(asset.warnings.empty()) << asset.warnings[0];
        EXPECT_EQ(asset.materials[0].normal_image, 0u);
        return asset.meshes[0].primitives[0].texcoords;
    };
    using Texcoords = std::vector<std::array<float, 2>>;
    EXPECT_EQ(texcoords({{"texCoord", 1}}), (Texcoords{{0.25f, 0.5f}, {1, 0}, {0, 1}}));
    EXPECT_EQ(texcoords({{"texCoord", 1}, {"offset", {0.5, 2}}, {"scale", {4, 2}}}),
              (Texcoords{{1.5f, 3}, {4.5f, 2}, {0.5f, 4}}));
    const Texcoords turned = texcoords(
        {{"texCoord", 1}, {"rotation", std::numbers::pi / 2}, {"offset", {10, 0}}, {"scale", {2, 1}}});
    const Texcoords expected{{10.5f, -0.5f}, {10, -2}, {11, 0}};
    for (size_t i = 0; i < expected.size(); ++i)
        for (size_t k = 0; k < 2; ++k) EXPECT_NEAR(turned[i][k], expected[i][k], 1e-6) << i;
    for (const auto& [u, v] : texcoords({{"texCoord", 1}, {"offset", {3e38, -3e38}}, {"scale", {3e38, 3e38}}}))
        EXPECT_TRUE(std::isfinite(u) && std::isfinite(v));
    b.json["materials"][0]["normalTexture"].erase("extensions");
    EXPECT_TRUE(has_warning(loaded(b), "materials[0].normalTexture: uses other texture coordinates"));
}

TEST(Import, AMaterialHasTheSamplerOfItsFirstTexture) {
    GlbBuilder b = tiny_character();
    const size_t view = b.add_view(std::vector<std::byte>(3));
    b.json["images"] = {{{"bufferView", view}, {"mimeType", "image/png"}}};
    b.json["samplers"] = {GltfJson::object(),
                          {{"magFilter", 9728}, {"minFilter", 9987}, {"wrapS", 33071}, {"wrapT", 33648}},
                          {{"magFilter", 9729}, {"wrapS", 10497}}};
    b.json["textures"] = {{{"source", 0}},
                          {{"source", 0}, {"sampler", 0}},
                          {{"source", 0}, {"sampler", 1}},
                          {{"source", 0}, {"sampler", 2}}};
    const auto sampler_of = [&](size_t texture) {
        b.json["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", texture}}}}},
                                {"normalTexture", {{"index", 2}}}}};
        const AssetMaterial material = loaded(b).materials[0];
        return std::tuple(material.filter, material.wrap_u, material.wrap_v);
    };
    const std::tuple usual(TextureFilter::kLinear, TextureWrap::kRepeat, TextureWrap::kRepeat);
    EXPECT_EQ(sampler_of(0), usual);
    EXPECT_EQ(sampler_of(1), usual);
    EXPECT_EQ(sampler_of(2), std::tuple(TextureFilter::kNearest, TextureWrap::kClamp, TextureWrap::kMirror));
    EXPECT_EQ(sampler_of(3), usual);
    b.json["textures"][3]["sampler"] = 3;
    EXPECT_EQ(sampler_of(3), usual);
    EXPECT_TRUE(has_warning(loaded(b), "textures[3].sampler: index 3"));
    b.json["textures"][3]["sampler"] = 1;
    b.json["samplers"][1]["wrapT"] = "up";
    EXPECT_EQ(sampler_of(3), usual);
    EXPECT_TRUE(has_warning(loaded(b), "samplers[1].wrapT: "));
}

TEST(Import, ColoursOfSpecularGlossinessAreReadWhereThereAreNoOthers) {
    GlbBuilder b = tiny_character();
    const size_t view = b.add_view(std::vector<std::byte>(3));
    b.json["images"] = {{{"bufferView", view}, {"mimeType", "image/png"}}};
    b.json["textures"] = {{{"source", 0}}};
    b.json["extensionsRequired"] = {"KHR_materials_pbrSpecularGlossiness"};
    b.json["materials"] = {{{"extensions",
                             {{"KHR_materials_pbrSpecularGlossiness",
                               {{"diffuseFactor", {0.5, 0.25, 0.125, 1}},
                                {"diffuseTexture", {{"index", 0}}},
                                {"glossinessFactor", 0.25}}}}}}};
    const AssetMaterial material = loaded(b).materials[0];
    EXPECT_EQ(material.base_color, (std::array<float, 4>{0.5f, 0.25f, 0.125f, 1}));
    EXPECT_EQ(std::tuple(material.image, material.metallic, material.roughness), std::tuple(0u, 0.0f, 0.75f));
    b.json["materials"][0]["pbrMetallicRoughness"] = {{"baseColorFactor", {1, 0, 0, 1}}};
    EXPECT_EQ(loaded(b).materials[0].base_color, (std::array<float, 4>{1, 0, 0, 1}));
}

// A character without its texture is still a character.
TEST(Import, MissingImages) {
    for (const char* uri :
         {"missing.png", "../up.png", "/etc/passwd", "http://localhost/a.png", "data:image/png;base64", "C:\\a.png"}) {
        GlbBuilder b = tiny_character();
        b.json["images"] = {{{"uri", uri}}};
        b.json["textures"] = {{{"source", 0}}};
        b.json["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
        const Asset asset = loaded(b);
        ASSERT_EQ(asset.images.size(), 1u) << uri;
        EXPECT_TRUE(asset.images[0].encoded.empty()) << uri;
        EXPECT_TRUE(has_warning(asset, "images[0].uri: ")) << uri;
        EXPECT_EQ(asset.warnings.size(), 1u) << uri;
    }
    GlbBuilder b = tiny_character();
    b.json["images"] = {{{"bufferView", 99}}};
    b.json["textures"] = {{{"source", 0}}};
    b.json["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
    expect_refused(b, "images[0].bufferView", "index 99");
}

TEST(Import, WarningsAreBounded) {
    GlbBuilder b = tiny_character();
    for (int i = 0; i < 500; ++i) b.json["nodes"].push_back({{"name", i}});
    const Asset asset = loaded(b);
    EXPECT_EQ(asset.warnings.size(), 101u);
    EXPECT_EQ(asset.warnings.back(), "file.glb: and 400 more");
    EXPECT_EQ(asset.warnings[0], "file.glb: nodes[3].name: is not a string: it is taken as no name");
}

// ---- EXT_meshopt_compression ----

// Moves a buffer view's content into a compressed one, and leaves a fallback buffer without data in its place.
void compress_view(GlbBuilder& b, size_t view, std::span<const unsigned char> compressed, size_t stride, size_t count,
                   const GltfJson& options) {
    const size_t inner = b.add_view(std::as_bytes(compressed));
    const GltfJson range = b.json["bufferViews"][inner];
    b.json["bufferViews"].erase(inner);
    GltfJson extension = {{"buffer", 0},
                          {"byteOffset", range["byteOffset"]},
                          {"byteLength", compressed.size()},
                          {"byteStride", stride},
                          {"count", count}};
    extension.update(options);
    const size_t length = b.json["bufferViews"][view]["byteLength"];
    if (b.json["buffers"].size() == 1)
        b.json["buffers"].push_back(
            {{"byteLength", 100'000}, {"extensions", {{"EXT_meshopt_compression", {{"fallback", true}}}}}});
    b.json["bufferViews"][view] = {{"buffer", 1},
                                   {"byteOffset", 0},
                                   {"byteLength", length},
                                   {"extensions", {{"EXT_meshopt_compression", extension}}}};
    if (options["mode"] == "ATTRIBUTES") b.json["bufferViews"][view]["byteStride"] = stride;
    b.json["extensionsUsed"] = b.json["extensionsRequired"] = {"EXT_meshopt_compression", "KHR_mesh_quantization"};
}

std::vector<unsigned char> encoded_vertices(const void* data, size_t count, size_t stride) {
    std::vector<unsigned char> out(meshopt_encodeVertexBufferBound(count, stride));
    out.resize(meshopt_encodeVertexBuffer(out.data(), out.size(), data, count, stride));
    return out;
}

GlbBuilder meshopt_character() {
    GlbBuilder b = tiny_character();
    // Positions as they are, indices as triangles, the rotations through the quaternion filter, normals octahedral.
    const std::vector<float> positions{0, 0, 0, 1, 0, 0, 0, 1, 0};
    compress_view(b, kPosition, encoded_vertices(positions.data(), 3, 12), 12, 3, {{"mode", "ATTRIBUTES"}});
    const std::vector<unsigned> indices{0, 1, 2};
    std::vector<unsigned char> packed(meshopt_encodeIndexBufferBound(3, 3));
    packed.resize(meshopt_encodeIndexBuffer(packed.data(), packed.size(), indices.data(), 3));
    compress_view(b, kIndices, packed, 2, 3, {{"mode", "TRIANGLES"}});

    const float half = std::sqrt(0.5f);
    const std::vector<float> rotations{0, 0, 0, 1, 0, 0, half, half};
    std::vector<int16_t> filtered(8);
    meshopt_encodeFilterQuat(filtered.data(), 2, 8, 16, rotations.data());
    sampler(b)["output"] = b.add<int16_t>(filtered, "VEC4", kInt16);
    b.json["accessors"].back()["normalized"] = true;
    compress_view(b, b.json["accessors"].back()["bufferView"], encoded_vertices(filtered.data(), 2, 8), 8, 2,
                  {{"mode", "ATTRIBUTES"}, {"filter", "QUATERNION"}});

    const std::vector<float> normals{0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 0};  // xyzw, as the encoder wants
    std::vector<int8_t> octahedral(12);
    meshopt_encodeFilterOct(octahedral.data(), 3, 4, 8, normals.data());
    attributes(b)["NORMAL"] = b.add<int8_t>(octahedral, "VEC3", kInt8);
    b.json["accessors"].back()["count"] = 3;
    b.json["accessors"].back()["normalized"] = true;
    compress_view(b, b.json["accessors"].back()["bufferView"], encoded_vertices(octahedral.data(), 3, 4), 4, 3,
                  {{"mode", "ATTRIBUTES"}, {"filter", "OCTAHEDRAL"}});
    return b;
}

TEST(Import, Meshopt) {
    const GlbBuilder good = meshopt_character();
    const Asset asset = loaded(good);
    const AssetPrimitive& p = asset.meshes.at(0).primitives.at(0);
    EXPECT_EQ(p.positions, (std::vector<Vec3<float>>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
    EXPECT_EQ(p.indices, (std::vector<uint32_t>{0, 1, 2}));
    EXPECT_NEAR(p.normals[0].z, 1, 0.02);
    EXPECT_NEAR(p.normals[1].y, 1, 0.02);
    EXPECT_NEAR(asset.clips.at(0).tracks.at(0).values[6], std::sqrt(0.5f), 1e-3);
    EXPECT_NEAR(asset.clips.at(0).tracks.at(0).values[7], std::sqrt(0.5f), 1e-3);

    // The other filter and the other mode.
    GlbBuilder b = tiny_character();
    const std::vector<float> times{0, 1};
    std::vector<uint32_t> exponential(2);
    meshopt_encodeFilterExp(exponential.data(), 2, 4, 16, times.data());
    compress_view(b, kTimes, encoded_vertices(exponential.data(), 2, 4), 4, 2,
                  {{"mode", "ATTRIBUTES"}, {"filter", "EXPONENTIAL"}});
    const std::vector<unsigned> indices{0, 1, 2};
    std::vector<unsigned char> packed(meshopt_encodeIndexSequenceBound(3, 3));
    packed.resize(meshopt_encodeIndexSequence(packed.data(), packed.size(), indices.data(), 3));
    compress_view(b, kIndices, packed, 2, 3, {{"mode", "INDICES"}});
    const Asset other = loaded(b);
    EXPECT_EQ(other.clips.at(0).duration_s, 1);
    EXPECT_EQ(other.meshes.at(0).primitives.at(0).indices, (std::vector<uint32_t>{0, 1, 2}));
}

// Its newer form: the same, and more that is refused by name.
TEST(Import, MeshoptOfKhronos) {
    const auto renamed = [](const GlbBuilder& b) {
        std::string text = b.json.dump();
        const std::string old = "EXT_meshopt", now = "KHR_meshopt";
        for (size_t at = 0; (at = text.find(old, at)) != std::string::npos;) text.replace(at, old.size(), now);
        GlbBuilder khronos = b;
        khronos.json = GltfJson::parse(text);
        return khronos;
    };
    const GlbBuilder good = meshopt_character();
    const Asset wanted = loaded(good), asset = loaded(renamed(good));
    EXPECT_EQ(asset.meshes.at(0).primitives.at(0).positions, wanted.meshes.at(0).primitives.at(0).positions);
    EXPECT_EQ(asset.meshes.at(0).primitives.at(0).indices, wanted.meshes.at(0).primitives.at(0).indices);
    EXPECT_EQ(asset.clips.at(0).tracks.at(0).values, wanted.clips.at(0).tracks.at(0).values);

    const std::string place = "bufferViews[0].extensions.KHR_meshopt_compression";
    GlbBuilder newer = renamed(good);
    const GltfJson& extension = newer.json["bufferViews"][0]["extensions"]["KHR_meshopt_compression"];
    newer.bin[extension["byteOffset"]] = std::byte{0xA1};
    expect_refused(load(newer), ErrorCode::kUnsupported, place, "version 1 of their codec");
    GlbBuilder colors = renamed(good);
    colors.json["bufferViews"][0]["extensions"]["KHR_meshopt_compression"]["filter"] = "COLOR";
    expect_refused(load(colors), ErrorCode::kUnsupported, place, "COLOR");
}

TEST(Import, BrokenMeshopt) {
    const std::string place = "bufferViews[0].extensions.EXT_meshopt_compression";
    const auto with = [](const char* key, const GltfJson& value) {
        GlbBuilder b = meshopt_character();
        b.json["bufferViews"][0]["extensions"]["EXT_meshopt_compression"][key] = value;
        return b;
    };
    expect_refused(with("mode", "MAGIC"), place, "mode 'MAGIC' is unknown");
    expect_refused(with("filter", "MAGIC"), place, "filter 'MAGIC' is unknown");
    expect_refused(with("filter", "QUATERNION"), place, "byteStride 12 is not allowed");
    expect_refused(with("byteStride", 6), place, "byteStride 6");
    expect_refused(with("byteStride", 260), place, "byteStride 260");
    expect_refused(with("byteStride", 0), place, "byteStride 0");
    expect_refused(with("count", 100), place, "broken");
    expect_refused(with("byteLength", 7), place, "broken");
    expect_refused(with("byteLength", 100'000), place, "ends at byte");
    expect_refused(with("buffer", 1), "buffers[1]", "has no uri");
    expect_refused(with("buffer", 9), place + ".buffer", "index 9");
    expect_refused(with("mode", "TRIANGLES"), place, "byteStride 12 is not allowed");
    expect_refused(with("count", 1ull << 50), place, "too few");
    expect_refused(with("count", 4'000'000'000u), place, "too few");
    GlbBuilder b = meshopt_character();
    b.json["bufferViews"][0]["byteLength"] = 37;
    expect_refused(b, "bufferViews[0]", "36 bytes are compressed");
}

// ---- KHR_draco_mesh_compression ----

GlbBuilder draco_character(int method) {
    GlbBuilder b = tiny_character();
    attributes(b).erase("NORMAL");
    draco::TriangleSoupMeshBuilder builder;
    builder.Start(2);
    const int position = builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
    const int joints = builder.AddAttribute(draco::GeometryAttribute::GENERIC, 4, draco::DT_UINT8);
    const int weights = builder.AddAttribute(draco::GeometryAttribute::GENERIC, 4, draco::DT_FLOAT32);
    const float corners[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
    const uint8_t joint[4][4] = {{0, 0, 0, 0}, {1, 0, 0, 0}, {0, 0, 0, 0}, {1, 0, 0, 0}};
    const float weight[4] = {1, 0, 0, 0};
    const int faces[2][3] = {{0, 1, 2}, {2, 1, 3}};
    for (int f = 0; f < 2; ++f) {
        const auto& c = faces[f];
        builder.SetAttributeValuesForFace(position, draco::FaceIndex(uint32_t(f)), corners[c[0]], corners[c[1]],
                                          corners[c[2]]);
        builder.SetAttributeValuesForFace(joints, draco::FaceIndex(uint32_t(f)), joint[c[0]], joint[c[1]], joint[c[2]]);
        builder.SetAttributeValuesForFace(weights, draco::FaceIndex(uint32_t(f)), weight, weight, weight);
    }
    const auto mesh = builder.Finalize();
    draco::Encoder encoder;
    encoder.SetEncodingMethod(method);
    draco::EncoderBuffer buffer;
    EXPECT_TRUE(encoder.EncodeMeshToBuffer(*mesh, &buffer).ok());
    const size_t view = b.add_view(std::as_bytes(std::span(buffer.data(), buffer.size())));
    for (const size_t accessor : {kPosition, kVertexJoints, kWeights, kIndices}) {
        b.json["accessors"][accessor].erase("bufferView");
        b.json["accessors"][accessor]["count"] = accessor == kIndices ? 6 : 4;
    }
    primitive(b)["extensions"]["KHR_draco_mesh_compression"] = {
        {"bufferView", view}, {"attributes", {{"POSITION", 0}, {"JOINTS_0", 1}, {"WEIGHTS_0", 2}}}};
    b.json["extensionsUsed"] = b.json["extensionsRequired"] = {"KHR_draco_mesh_compression"};
    return b;
}

TEST(Import, Draco) {
    for (const int method : {int(draco::MESH_SEQUENTIAL_ENCODING), int(draco::MESH_EDGEBREAKER_ENCODING)}) {
        const Asset asset = loaded(draco_character(method));
        const AssetPrimitive& p = asset.meshes.at(0).primitives.at(0);
        ASSERT_EQ(p.positions.size(), 4u);
        ASSERT_EQ(p.indices.size(), 6u);
        std::set<std::pair<float, float>> corners;
        for (size_t v = 0; v < 4; ++v) {
            corners.emplace(p.positions[v].x, p.positions[v].y);
            EXPECT_EQ(p.influence_joints[v * 4], p.positions[v].x > 0.5f ? 1 : 0);
            EXPECT_EQ(p.influence_weights[v * 4], 1);
        }
        EXPECT_EQ(corners.size(), 4u);
    }
}

TEST(Import, DracoLeavesMorphTargetsAlone) {
    GlbBuilder b = draco_character(draco::MESH_SEQUENTIAL_ENCODING);
    primitive(b)["targets"] = {{{"POSITION", b.add<float>({1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12}, "VEC3", kFloat)}}};
    const AssetMorphTarget target = loaded(b).meshes[0].primitives[0].targets.at(0);
    EXPECT_EQ(target.positions, (std::vector<Vec3<float>>{{1, 2, 3}, {4, 5, 6}, {7, 8, 9}, {10, 11, 12}}));
    primitive(b)["targets"][0]["POSITION"] = b.add<float>({1, 2, 3}, "VEC3", kFloat);
    expect_refused(b, "meshes[0].primitives[0].targets[0].POSITION", "has 1 elements, but POSITION has 4");
}

TEST(Import, BrokenDraco) {
    const std::string place = "meshes[0].primitives[0].extensions.KHR_draco_mesh_compression";
    const GlbBuilder good = draco_character(draco::MESH_EDGEBREAKER_ENCODING);
    const auto extension = [](GlbBuilder& b) -> GltfJson& {
        return primitive(b)["extensions"]["KHR_draco_mesh_compression"];
    };
    GlbBuilder b = good;
    extension(b)["bufferView"] = 0;
    expect_refused(b, place, "not a Draco mesh");
    extension(b)["bufferView"] = 99;
    expect_refused(b, place + ".bufferView", "index 99");
    b = good;
    extension(b)["attributes"]["POSITION"] = 77;
    expect_refused(b, place + ".attributes.POSITION", "no attribute of this id");
    extension(b)["attributes"]["POSITION"] = 1;
    expect_refused(b, place + ".attributes.POSITION", "has 4 components, but its accessor is VEC3");
    b = good;
    b.json["accessors"][kPosition]["count"] = 5;
    expect_refused(b, place + ".attributes.POSITION", "has 4 vertices, but accessors[0] has 5");
    // Any byte of the stream may be wrong, or the stream end early.
    const size_t view = extension(b)["bufferView"];
    const size_t offset = good.json["bufferViews"][view]["byteOffset"],
                 length = good.json["bufferViews"][view]["byteLength"];
    for (size_t i = 0; i < length; ++i) {
        b = good;
        b.json["bufferViews"][view]["byteLength"] = i;
        EXPECT_FALSE(load(b).ok()) << i;
        for (const int value : {0, 1, 0x7F, 0x80, 0xFF}) {
            b = good;
            b.bin[offset + i] = std::byte(value);
            (void)load(b).ok();
        }
    }
}

// ---- The files that others made ----

struct Counts {
    int loaded_count = 0, refused_count = 0;
};

// Loads all glTF files below `folder`: each within 5 s, and each refused with one line that begins with its name.
Counts load_all(const fs::path& folder, const std::set<std::string>& must_refuse,
                const std::set<std::string>& must_load) {
    Counts counts;
    std::set<std::string> met;
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
        const std::string extension = entry.path().extension().string(), name = entry.path().filename().string();
        if (extension != ".glb" && extension != ".gltf") continue;
        const auto start = std::chrono::steady_clock::now();
        const Result<Asset> result = load_asset(entry.path());
        EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(5)) << name;
        met.insert(name);
        if (result.ok()) {
            ++counts.loaded_count;
            EXPECT_FALSE(must_refuse.contains(name)) << name << " must be refused";
            for (const std::string& line : result->warnings) {
                EXPECT_TRUE(line.starts_with(name + ": ")) << line;
                EXPECT_EQ(line.find('\n'), std::string::npos) << line;
            }
        } else {
            ++counts.refused_count;
            const std::string text = result.error().text();
            EXPECT_FALSE(must_load.contains(name)) << text;
            EXPECT_TRUE(text.starts_with(name + ": ")) << text;
            EXPECT_FALSE(result.error().message.empty()) << name;
            EXPECT_EQ(text.find_first_of("\r\n"), std::string::npos) << text;
        }
    }
    for (const auto* names : {&must_refuse, &must_load})
        for (const std::string& name : *names) EXPECT_TRUE(met.contains(name)) << name << " is not there";
    std::printf("%s: %d loaded, %d refused\n", folder.c_str(), counts.loaded_count, counts.refused_count);
    return counts;
}

TEST(Import, Characters) {
    const fs::path folder = shared_folder("characters");
    if (!fs::exists(folder)) GTEST_SKIP() << "no shared folder";
    const Counts counts = load_all(folder, {}, {});
    EXPECT_EQ(counts.refused_count, 0);
    EXPECT_GE(counts.loaded_count, 10);
}

TEST(Import, InvalidFiles) {
    const fs::path folder = shared_folder("invalid");
    if (!fs::exists(folder)) GTEST_SKIP() << "no shared folder";
    const std::set<std::string> must_refuse{
        // The file as a whole.
        "empty.gltf", "space.gltf", "null.gltf", "array.gltf", "deep_json.gltf", "nan_literal.gltf", "version_1.gltf",
        "glb_cut_1.glb", "glb_cut_3.glb", "glb_cut_11.glb", "glb_cut_15.glb", "glb_cut_20.glb", "glb_cut_03.glb",
        "glb_cut_09.glb", "glb_total_small.glb", "glb_chunk_big.glb", "glb_chunk_zero.glb", "glb_nobin.glb",
        "glb__only_header.glb", "glb__length_mismatch.glb", "GltfImporter__Test__version-legacy.gltf",
        "GltfImporter__Test__version-unsupported.gltf",
        // Indices and trees that lie.
        "joint_negative.gltf", "joint_float.gltf", "joint_string.gltf", "node_self_child.gltf", "scene_index_oor.gltf",
        "mesh_index_oor.gltf", "skeleton_oor.gltf", "ibm_oor.gltf", "anim_sampler_oor.gltf", "anim_node_oor.gltf",
        "vjoint_oor.glb", "node__node_loop.gltf", "node__node_loop_scene.gltf", "node__node_parent_override.gltf",
        "node__unresolved_child_node.gltf", "skin__unresolved_joint.gltf", "material__unresolved_normal.gltf",
        "material__unresolved_emissive.gltf", "GltfImporter__Test__scene-invalid-cycle.gltf",
        "GltfImporter__Test__scene-invalid-cycle-deep.gltf", "GltfImporter__Test__scene-invalid-multiple-parents.gltf",
        "mesh_data__index_buffer_oob.gltf", "mesh_data__index_buffer_primitive_restart.gltf",
        "GltfImporter__Test__mesh-invalid-sparse-indices.gltf",
        // Counts, types and bounds that lie.
        "ibm_short.gltf", "ibm_comp.gltf", "anim_in_huge.gltf", "anim_in_vec3.gltf", "anim_out_vec3.gltf",
        "anim_interp.gltf", "rot_3.gltf", "trs_huge.gltf", "scale_string.gltf", "bv_past_end.gltf",
        "bv_off_overflow.gltf", "bv_negative.gltf", "bv_stride_1.gltf", "acc_off.gltf", "acc_type.gltf",
        "acc_comp.gltf", "buffer_huge.gltf", "joints_float.gltf", "weights_missing.gltf", "mode_99.gltf",
        "animation__sampler_output_count_invalid.gltf", "mesh__unequal_joints.gltf",
        // URIs.
        "uri_traversal.gltf", "uri_abs.gltf", "uri_dev.gltf", "uri_http.gltf", "uri_no_comma.gltf", "uri_percent.gltf",
        // Values.
        "key_nan.glb", "quat_nan.glb", "animation_data__invalid_input_values.gltf"};
    const std::set<std::string> must_load{"chain_deep.gltf",
                                          "wide_nodes.gltf",
                                          "clips_20000.glb",
                                          "matrix_and_trs.gltf",
                                          "anim_duplicate.gltf",
                                          "anim_no_channels.gltf",
                                          "name_number.gltf",
                                          "dup_keys.gltf",
                                          "key_back.glb",
                                          "key_same.glb",
                                          "ibm_zero.glb",
                                          "position_missing.gltf",
                                          "weights_neg.glb",
                                          "camera__empty_objects.gltf",
                                          "camera__extra_type.gltf",
                                          "camera__orthographic_xy.gltf",
                                          "camera__orthographic_z.gltf",
                                          "camera__perspective_z.gltf",
                                          "node__unresolved_camera.gltf",
                                          "node__rotation_non_unit.gltf",
                                          "node__matrix_trs.gltf",
                                          "node__skin_with_no_mesh.gltf",
                                          "scene__non_root_node.gltf",
                                          "mesh_data__colors_non_clamped.gltf",
                                          "animation__channel_duplicate_targets.gltf",
                                          "GltfImporter__Test__camera-invalid.gltf",
                                          "GltfImporter__Test__light-invalid.gltf"};
    const Counts counts = load_all(folder, must_refuse, must_load);
    EXPECT_GT(counts.loaded_count, 0);
    EXPECT_GT(counts.refused_count, 0);
}

}  // namespace
}  // namespace throng::test
