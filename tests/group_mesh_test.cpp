// Crowd::mesh() gives an application all it needs to draw a group: every section at every level of detail.
#include "tests/crowd_cases.h"
#include "tests/kernel_runner.h"
#include "tests/subset.h"
#include "tools/creatures/creature.h"

#include <gtest/gtest.h>

namespace throng::test {
namespace {

const InSubset kGroupMeshNatively({Subset::kNative}, {"GroupMesh.*"});

// A creature whose triangles are divided among three sections, each with all vertices.
Character in_three_sections() {
    Asset asset = make_creature({.joint_count = 60, .level_count = 20, .face_count = 1500}).value();
    std::vector<AssetPrimitive>& primitives = asset.meshes[0].primitives;
    const std::vector<uint32_t> all = primitives[0].indices;
    primitives.resize(3, primitives[0]);
    for (AssetPrimitive& primitive : primitives) primitive.indices.clear();
    for (size_t i = 0; i < all.size(); ++i) primitives[i / 3 * 3 / (all.size() / 3)].indices.push_back(all[i]);
    return compile_character(asset).value();
}

template <class T>
std::vector<T> contents(const BufferView& view) {
    EXPECT_EQ(view.stride_bytes, sizeof(T));
    return download<T>(test_gpu(), BufferRange(view.buffer, view.offset_bytes, view.size_bytes));
}

TEST(GroupMesh, MatchesTheCharacterAtEveryLevelOfDetail) {
    const Character character = in_three_sections();
    ASSERT_EQ(character.sections.size(), 3u);
    ASSERT_GE(character.lods.size(), 2u);
    Crowd crowd = create({.groups = {{.character = &character, .instance_count = 3}},
                          .path = UpdatePath::kFused,
                          .culling = Culling{.reduces_joints = true}});
    ASSERT_TRUE(crowd.update(0));
    const GroupMesh mesh = crowd.mesh(0).value();
    ASSERT_EQ(mesh.lod_count, 1 + character.lods.size());
    ASSERT_EQ(mesh.section_lods.size(), 3 * mesh.lod_count);
    if (test_gpu()->is_native()) {
        EXPECT_FALSE(mesh.vertex || mesh.influences || mesh.index || mesh.morph_delta);
        return;
    }
    EXPECT_FALSE(mesh.morph_delta);
    EXPECT_TRUE(same_bits(contents<Vertex>(mesh.vertex), character.vertices));
    const std::vector<Influences> influences = contents<Influences>(mesh.influences);
    const std::vector<uint32_t> indices = contents<uint32_t>(mesh.index);
    const OutputBlock& block = crowd.outputs()[0];
    for (uint32_t s = 0; s < 3; ++s)
        for (uint32_t lod = 0; lod < mesh.lod_count; ++lod) {
            const MeshSection& section = character.sections[s];
            const SectionLod& of = mesh.section_lods[s * mesh.lod_count + lod];
            const IndexRange range = lod == 0 ? IndexRange{section.first_index, section.index_count}
                                              : character.lod_ranges[(lod - 1) * 3 + s];
            const std::vector<uint32_t>& from = lod == 0 ? character.indices : character.lod_indices;
            ASSERT_TRUE(lod > 0 || of.index_count > 0);  // a section may vanish at a distance
            ASSERT_LE(of.first_index + of.index_count, indices.size());
            EXPECT_TRUE(same_bits(std::span(indices).subspan(of.first_index, of.index_count),
                                  std::span(from).subspan(range.first_index, range.index_count)));
            const std::vector<Influences> of_lod = influences_of_lod(character, lod);
            const size_t count = size_t{section.vertex_count} * section.influence_sets;
            ASSERT_LE(of.first_influences + count, influences.size());
            EXPECT_TRUE(same_bits(std::span<const Influences>(influences).subspan(of.first_influences, count),
                                  std::span<const Influences>(of_lod).subspan(section.first_influences, count)));

            const auto draw = download<VkDrawIndexedIndirectCommand>(
                test_gpu(), BufferRange(block.draw.buffer, block.draw_offset_bytes(s, lod),
                                        sizeof(VkDrawIndexedIndirectCommand)))[0];
            EXPECT_EQ(draw.firstIndex, of.first_index);
            EXPECT_EQ(draw.indexCount, of.index_count);
            EXPECT_EQ(draw.vertexOffset, static_cast<int32_t>(section.first_vertex));
            EXPECT_EQ(draw.firstInstance, 0u);
        }
}

TEST(GroupMesh, AnUnknownGroupIsRefused) {
    const Character character = in_three_sections();
    const Crowd crowd = create({.groups = {{.character = &character, .instance_count = 3}}});
    EXPECT_EQ(crowd.mesh(1).error().code, ErrorCode::kInvalidArgument);
}

}  // namespace
}  // namespace throng::test
