// Importing buffers compressed with EXT_meshopt_compression and KHR_meshopt_compression.
#include "tests/files.h"
#include "tests/host/import_cases.h"

#include <meshoptimizer.h>

#include <cmath>
#include <cstring>

namespace throng::test {
namespace {

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
    // Positions unfiltered, indices as triangles, rotations with the quaternion filter, normals octahedral.
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

    // The remaining filter and mode.
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

// The newer extension, without and with what it adds (import_meshopt_v1_test.cpp).
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

    GlbBuilder newer = tiny_character();
    const std::string positions = read_file(std::string(THRONG_SOURCE_DIR) + "/tests/data/meshopt/triangle.bin");
    const std::vector<unsigned char> compressed(positions.begin(), positions.end());
    ASSERT_FALSE(compressed.empty());
    EXPECT_EQ(compressed[0], 0xA1);
    compress_view(newer, kPosition, compressed, 12, 3, {{"mode", "ATTRIBUTES"}});
    const std::string place = "bufferViews[0].extensions.KHR_meshopt_compression";
    for (const GlbBuilder& b : {newer, renamed(newer)}) {
        const Asset with_version_1 = loaded(b);
        EXPECT_EQ(with_version_1.meshes.at(0).primitives.at(0).positions,
                  wanted.meshes.at(0).primitives.at(0).positions);
    }
    newer = renamed(newer);
    newer.bin.back() = std::byte{3};
    expect_refused(newer, place, "channel mode 3 is unknown");
    newer.json["bufferViews"][0]["extensions"]["KHR_meshopt_compression"]["filter"] = "COLOR";
    expect_refused(newer, place, "byteStride 12 is not allowed with filter COLOR");
}

TEST(Import, MeshoptMemoryIsGivenBack) {
    GlbBuilder b = meshopt_character();
    b.json["buffers"][0]["byteLength"] = b.bin.size();
    OpenedBuffers file(b);
    const JsonView accessor = file.root().required_array("accessors")[kPosition];
    for (int round = 0; round < 2; ++round) {
        const auto bytes = file.buffers.view_of(accessor).bytes;
        ASSERT_EQ(bytes.size(), 36u);
        float x = 0;
        std::memcpy(&x, bytes.data() + 12, sizeof(x));
        EXPECT_EQ(x, 1) << "of the second vertex";
        EXPECT_EQ(file.buffers.view_of(accessor).bytes.data(), bytes.data()) << "decompressed once";
        EXPECT_FALSE(has_room(file.budget, gltf::kMemoryLimitBytes - 35));
        file.buffers.free_decompressed();
        EXPECT_TRUE(has_room(file.budget, gltf::kMemoryLimitBytes));
    }
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

}  // namespace
}  // namespace throng::test
