// Importing whole files: their JSON, their parts, unneeded parts, and files from other sources.
#include "tests/files.h"
#include "tests/host/import_cases.h"
#include "tests/shared.h"

#include <chrono>
#include <filesystem>
#include <fstream>
#include <set>

#include <sys/stat.h>

namespace throng::test {
namespace {

namespace fs = std::filesystem;

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

TEST(Import, NoFile) {
    const auto missing = load_asset("/nowhere/fox.glb");
    ASSERT_FALSE(missing.ok());
    EXPECT_EQ(missing.error().code, ErrorCode::kFile);
    EXPECT_EQ(missing.error().text(), "fox.glb: no such file: /nowhere/fox.glb");
    const auto nameless = load_asset("");
    ASSERT_FALSE(nameless.ok());
    EXPECT_EQ(nameless.error().message, "the name of the file is empty");
    const TemporaryFolder folder;
    const auto directory = load_asset(folder.path());
    ASSERT_FALSE(directory.ok());
    EXPECT_EQ(directory.error().message, "not a regular file: " + folder.path().string());
    // Opening a pipe without a writer must not block.
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
    expect_refused(with_uri("a%zz.bin"), ErrorCode::kFile, place, "'a%zz.bin' cannot be found");
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
    // 40 MB of empty objects would take gigabytes when parsed.
    std::string many = "{\"asset\":{\"version\":\"2.0\"},\"nodes\":[{}";
    for (int i = 0; i < 13'000'000; ++i) many += ",{}";
    expect_refused(load(many + "]}"), ErrorCode::kLimit, "", "12 times the size of the file");
    // An error is one short line, whatever the file contains.
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
    EXPECT_EQ(loaded(b).warnings,
              (std::vector<std::string>{"file.glb: extensionsUsed: KHR_materials_unlit, KHR_materials_sheen: not "
                                        "supported; materials are drawn without them"}));
    b.json["extensionsRequired"] = {"KHR_materials_unlit", "EXT_mesh_gpu_instancing"};
    expect_refused(load(b), ErrorCode::kUnsupported, "extensionsRequired[1]", "EXT_mesh_gpu_instancing");
}

// Cameras, lights, extras and the like are not read.
TEST(Import, UnneededPartsMayBeBroken) {
    GlbBuilder b = tiny_character();
    b.json["cameras"] = {1, "two", {{"type", "perspective"}}};
    b.json["nodes"][0]["camera"] = 99;
    b.json["extras"] = {{"a", nullptr}};
    b.json["samplers"] = 5;
    b.json["accessors"][kPosition]["min"] = "wrong";
    b.json["materials"] = {{{"extensions", {{"KHR_materials_sheen", "soft"}}}}};
    b.json["nodes"][1]["name"] = 5;
    b.json["accessors"].push_back({{"bufferView", 1234}});  // not used by anything
    const Asset asset = loaded(b);
    EXPECT_TRUE(has_warning(asset, "nodes[1].name"));
    EXPECT_EQ(asset.warnings.size(), 1u);
}

TEST(Import, WarningsAreBounded) {
    GlbBuilder b = tiny_character();
    for (int i = 0; i < 500; ++i) b.json["nodes"].push_back({{"name", i}});
    const Asset asset = loaded(b);
    EXPECT_EQ(asset.warnings.size(), 101u);
    EXPECT_EQ(asset.warnings.back(), "file.glb: and 400 more warnings");
    EXPECT_EQ(asset.warnings[0], "file.glb: nodes[3].name: is not a string: it is ignored");
}

struct Counts {
    int loaded_count = 0, refused_count = 0;
};

// Loads all glTF files below `folder`: none hangs, and each that is refused is so with one line that begins with its
// name.
Counts load_all(const fs::path& folder, const std::set<std::string>& must_refuse,
                const std::set<std::string>& must_load) {
    Counts counts;
    std::set<std::string> met;
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
        const std::string extension = entry.path().extension().string(), name = entry.path().filename().string();
        if (extension != ".glb" && extension != ".gltf") continue;
        const auto start = std::chrono::steady_clock::now();
        const Result<Asset> result = load_asset(entry.path());
        EXPECT_LT(std::chrono::steady_clock::now() - start, kHang) << name;
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
        // Invalid files as a whole.
        "empty.gltf", "space.gltf", "null.gltf", "array.gltf", "deep_json.gltf", "nan_literal.gltf", "version_1.gltf",
        "glb_cut_1.glb", "glb_cut_3.glb", "glb_cut_11.glb", "glb_cut_15.glb", "glb_cut_20.glb", "glb_cut_03.glb",
        "glb_cut_09.glb", "glb_total_small.glb", "glb_chunk_big.glb", "glb_chunk_zero.glb", "glb_nobin.glb",
        "glb__only_header.glb", "glb__length_mismatch.glb", "GltfImporter__Test__version-legacy.gltf",
        "GltfImporter__Test__version-unsupported.gltf",
        // Invalid indices and trees.
        "joint_negative.gltf", "joint_float.gltf", "joint_string.gltf", "node_self_child.gltf", "scene_index_oor.gltf",
        "mesh_index_oor.gltf", "skeleton_oor.gltf", "ibm_oor.gltf", "anim_sampler_oor.gltf", "anim_node_oor.gltf",
        "vjoint_oor.glb", "node__node_loop.gltf", "node__node_loop_scene.gltf", "node__node_parent_override.gltf",
        "node__unresolved_child_node.gltf", "skin__unresolved_joint.gltf", "material__unresolved_normal.gltf",
        "material__unresolved_emissive.gltf", "GltfImporter__Test__scene-invalid-cycle.gltf",
        "GltfImporter__Test__scene-invalid-cycle-deep.gltf", "GltfImporter__Test__scene-invalid-multiple-parents.gltf",
        "mesh_data__index_buffer_oob.gltf", "mesh_data__index_buffer_primitive_restart.gltf",
        "GltfImporter__Test__mesh-invalid-sparse-indices.gltf",
        // Invalid counts, types and bounds.
        "ibm_short.gltf", "ibm_comp.gltf", "anim_in_huge.gltf", "anim_in_vec3.gltf", "anim_out_vec3.gltf",
        "anim_interp.gltf", "rot_3.gltf", "trs_huge.gltf", "scale_string.gltf", "bv_past_end.gltf",
        "bv_off_overflow.gltf", "bv_negative.gltf", "bv_stride_1.gltf", "acc_off.gltf", "acc_type.gltf",
        "acc_comp.gltf", "buffer_huge.gltf", "joints_float.gltf", "weights_missing.gltf", "mode_99.gltf",
        "animation__sampler_output_count_invalid.gltf", "mesh__unequal_joints.gltf",
        // Invalid URIs.
        "uri_traversal.gltf", "uri_abs.gltf", "uri_dev.gltf", "uri_http.gltf", "uri_no_comma.gltf", "uri_percent.gltf",
        // Invalid values.
        "key_nan.glb", "quat_nan.glb"};
    const std::set<std::string> must_load{"chain_deep.gltf",
                                          "animation_data__invalid_input_values.gltf",
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
