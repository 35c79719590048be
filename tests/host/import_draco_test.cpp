// Importing meshes compressed with KHR_draco_mesh_compression.
#include "import/draco.h"
#include "tests/host/import_cases.h"

#include <draco/compression/encode.h>
#include <draco/mesh/mesh.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>

#include <set>

namespace throng::test {
namespace {

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

// A decoded mesh counts against the budget while it exists; the decoder's own memory counts only during decoding.
TEST(Import, DracoGivesItsMemoryBack) {
    GlbBuilder b = draco_character(draco::MESH_EDGEBREAKER_ENCODING);
    b.json["buffers"][0]["byteLength"] = b.bin.size();
    OpenedBuffers file(b);
    const JsonView primitive = file.root().required_array("meshes")[0].required_array("primitives")[0];
    {
        const gltf::DracoMesh mesh(*primitive.extension("KHR_draco_mesh_compression"), file.buffers, file.budget);
        // 2 triangles of 12 bytes; 4 vertices of 12, 4 and 16 bytes, and 4 more per vertex for each attribute.
        EXPECT_TRUE(has_room(file.budget, gltf::kMemoryLimitBytes - 200));
        EXPECT_FALSE(has_room(file.budget, gltf::kMemoryLimitBytes - 199));
        gltf::AccessorFormat format{.type = "VEC3", .component_count = 3, .count = 4};
        const auto view = mesh.attribute("POSITION", format);
        ASSERT_TRUE(view);
        EXPECT_EQ(view->count(), 4u);
        EXPECT_FALSE(has_room(file.budget, gltf::kMemoryLimitBytes - 200)) << "the vertices as floats";
    }
    EXPECT_TRUE(has_room(file.budget, gltf::kMemoryLimitBytes));
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
    expect_refused(b, place + ".attributes.POSITION", "no attribute with this id");
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

}  // namespace
}  // namespace throng::test
