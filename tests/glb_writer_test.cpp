// The .glb files that the creature generator writes, read by another reader.
#include "../tools/creatures/creature.h"
#include "../tools/creatures/glb_writer.h"

#include <gtest/gtest.h>
#include <tiny_gltf.h>

#include <algorithm>
#include <cstring>
#include <string>
#include <vector>

namespace throng {
namespace {

tinygltf::Model read_back(const Asset& asset) {
    const auto bytes = write_glb(asset);
    EXPECT_TRUE(bytes.ok());
    tinygltf::Model model;
    std::string error, warning;
    tinygltf::TinyGLTF loader;
    EXPECT_TRUE(loader.LoadBinaryFromMemory(
        &model, &error, &warning, reinterpret_cast<const unsigned char*>(bytes->data()), unsigned(bytes->size())));
    EXPECT_EQ(error, "");
    EXPECT_EQ(warning, "");
    return model;
}

TEST(GlbWriter, IsReadByTinygltf) {
    for (const CreatureSettings& settings : {CreatureSettings{300, 60, 1500, 1},
                                             {1, 1, 20, 1},
                                             {1000, 15, 150000, 2},
                                             creature_settings(CreatureKind::kWillow),
                                             creature_settings(CreatureKind::kWalker),
                                             creature_settings(CreatureKind::kCentipede)}) {
        SCOPED_TRACE(std::to_string(settings.joint_count) + " joints");
        const Asset asset = make_creature(settings).value();
        const tinygltf::Model model = read_back(asset);
        EXPECT_EQ(model.asset.version, "2.0");
        EXPECT_EQ(model.asset.generator, "throng");
        ASSERT_EQ(model.skins.size(), 1u);
        EXPECT_EQ(model.skins[0].joints.size(), settings.joint_count);
        ASSERT_EQ(model.scenes.size(), 1u);
        EXPECT_EQ(model.scenes[0].nodes, (std::vector<int>{0, int(settings.joint_count)}));
        uint32_t levels = 0;
        const auto visit = [&](const auto& self, int node, uint32_t level) -> void {
            levels = std::max(levels, level);
            for (const int child : model.nodes[size_t(node)].children) self(self, child, level + 1);
        };
        visit(visit, 0, 1);
        EXPECT_EQ(levels, settings.level_count);
        ASSERT_EQ(model.animations.size(), asset.clips.size());
        for (const tinygltf::Animation& clip : model.animations) {
            EXPECT_EQ(clip.channels.size(), settings.joint_count + 1);
            for (const tinygltf::AnimationSampler& sampler : clip.samplers)
                EXPECT_EQ(sampler.input, clip.samplers[0].input);
        }
        ASSERT_EQ(model.meshes.at(0).primitives.size(), asset.meshes[0].primitives.size());
        for (size_t i = 0; i < asset.meshes[0].primitives.size(); ++i) {
            const tinygltf::Primitive& primitive = model.meshes[0].primitives[i];
            const AssetPrimitive& wanted = asset.meshes[0].primitives[i];
            EXPECT_EQ(model.accessors[size_t(primitive.indices)].count, wanted.indices.size());
            for (const char* semantic : {"POSITION", "NORMAL", "COLOR_0", "JOINTS_0", "WEIGHTS_0"})
                EXPECT_EQ(model.accessors[size_t(primitive.attributes.at(semantic))].count, wanted.positions.size())
                    << semantic;
            EXPECT_EQ(model.materials.at(size_t(primitive.material)).name, asset.materials[wanted.material].name);
        }
        EXPECT_TRUE(model.materials.at(0).doubleSided);
    }
}

// The specification's requirements on every accessor, checked by another reader on the written file.
TEST(GlbWriter, AccessorsLieInTheirBufferAndInTheirRange) {
    const tinygltf::Model model = read_back(make_creature({64, 15, 1500, 1}).value());
    for (size_t i = 0; i < model.accessors.size(); ++i) {
        SCOPED_TRACE("accessor " + std::to_string(i));
        const tinygltf::Accessor& accessor = model.accessors[i];
        const tinygltf::BufferView& view = model.bufferViews.at(size_t(accessor.bufferView));
        const size_t stride = size_t(accessor.ByteStride(view));
        const size_t components = size_t(tinygltf::GetNumComponentsInType(uint32_t(accessor.type)));
        EXPECT_EQ(view.byteOffset % 4, 0u);
        EXPECT_LE(accessor.count * stride, view.byteLength);
        EXPECT_LE(view.byteOffset + view.byteLength, model.buffers.at(0).data.size());
        if (accessor.minValues.empty()) continue;
        ASSERT_EQ(accessor.minValues.size(), components);
        std::vector<double> least(components, 1e30), most(components, -1e30);
        for (size_t k = 0; k < accessor.count * components; ++k) {
            float value;
            std::memcpy(&value, &model.buffers[0].data[view.byteOffset + k / components * stride + k % components * 4],
                        4);
            least[k % components] = std::min(least[k % components], double(value));
            most[k % components] = std::max(most[k % components], double(value));
        }
        for (size_t c = 0; c < components; ++c) {
            EXPECT_EQ(float(accessor.minValues[c]), float(least[c]));
            EXPECT_EQ(float(accessor.maxValues[c]), float(most[c]));
        }
    }
    for (const tinygltf::Animation& clip : model.animations)
        EXPECT_FALSE(model.accessors[size_t(clip.samplers[0].input)].minValues.empty());
    const tinygltf::Skin& skin = model.skins[0];
    const tinygltf::BufferView& view =
        model.bufferViews[size_t(model.accessors[size_t(skin.inverseBindMatrices)].bufferView)];
    for (size_t joint = 0; joint < skin.joints.size(); ++joint) {
        float m[16];
        std::memcpy(m, &model.buffers[0].data[view.byteOffset + joint * sizeof m], sizeof m);
        EXPECT_TRUE(m[3] == 0 && m[7] == 0 && m[11] == 0 && m[15] == 1) << "joint " << joint;
    }
}

TEST(GlbWriter, RefusesWhatItCannotWrite) {
    Asset asset = make_creature({3, 3, 20, 1}).value();
    asset.images.resize(1);
    EXPECT_EQ(write_glb(asset).error().code, ErrorCode::kUnsupported);
    asset.images.clear();
    asset.meshes[0].primitives[0].influence_count = 8;
    EXPECT_EQ(write_glb(asset).error().place, "meshes[0]");
}

TEST(GlbWriter, EscapesNames) {
    Asset asset = make_creature({1, 1, 20, 1}).value();
    asset.nodes[0].name = "a \"quoted\" \\ name\n\x01 ü";
    EXPECT_EQ(read_back(asset).nodes[0].name, asset.nodes[0].name);
}

}  // namespace
}  // namespace throng
