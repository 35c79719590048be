// Importing morph targets and their weights.
#include "tests/host/import_cases.h"
#include "tests/test_rig.h"

#include <cmath>

namespace throng::test {
namespace {

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
        EXPECT_TRUE(has_warning(asset, "meshes[0].extras.targetNames: does not have a name for each morph target"));
    }
    b.json["meshes"][0]["extras"] = 5;
    EXPECT_TRUE(loaded(b).meshes[0].target_names.empty());
}

// UniVRM writes meshes in this way: all primitives share the vertices and targets, and each uses some of the vertices.
// If each primitive kept all of them, they would take 240 MB, and their accessors as much again.
TEST(Import, PrimitivesThatShareMorphTargetsKeepTheirOwnVertices) {
    GlbBuilder b = tiny_character();
    const std::array<float, 3> moved{7, 8, 9};
    const std::array<uint16_t, 1> which{40'000};
    const size_t view = b.add_view(std::as_bytes(std::span(moved))),
                 index = b.add_view(std::as_bytes(std::span(which)));
    b.json["accessors"].push_back({{"componentType", kFloat}, {"count", 50'000}, {"type", "VEC3"}});
    const size_t positions = b.json["accessors"].size() - 1;
    b.json["accessors"].push_back(b.json["accessors"].back());
    b.json["accessors"].back()["sparse"] = {{"count", 1},
                                            {"indices", {{"bufferView", index}, {"componentType", kUint16}}},
                                            {"values", {{"bufferView", view}}}};
    b.json["nodes"][0].erase("skin");
    attributes(b) = {{"POSITION", positions}};
    primitive(b)["indices"] = b.add<uint16_t>({3, 40'000, 2}, "SCALAR", kUint16);
    for (int t = 0; t < 40; ++t) primitive(b)["targets"].push_back({{"POSITION", positions + 1}});
    const GltfJson one = primitive(b);
    for (int p = 1; p < 10; ++p) b.json["meshes"][0]["primitives"].push_back(one);
    const Asset asset = loaded(b);
    ASSERT_EQ(asset.meshes.size(), 1u);
    ASSERT_EQ(asset.meshes[0].primitives.size(), 10u);
    for (const AssetPrimitive& p : asset.meshes[0].primitives) {
        EXPECT_EQ(p.positions.size(), 3u);
        EXPECT_EQ(p.indices, (std::vector<uint32_t>{1, 2, 0}));
        ASSERT_EQ(p.targets.size(), 40u);
        for (const AssetMorphTarget& target : p.targets)
            EXPECT_EQ(target.positions, (std::vector<Vec3<float>>{{0, 0, 0}, {0, 0, 0}, {7, 8, 9}}));
    }
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
    // Many targets that share one accessor take almost no space in a file.
    GlbBuilder b = tiny_character();
    b.json["accessors"].push_back({{"componentType", kFloat}, {"count", 100'000}, {"type", "VEC3"}});
    attributes(b) = {{"POSITION", 8}};
    primitive(b).erase("indices");
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

}  // namespace
}  // namespace throng::test
