// What compile_character() adds for drawing: levels of detail, and the bounds of clips.
#include "compile/file/character_file.h"
#include "compile/mesh/lod.h"
#include "reference/reference.h"
#include "skin/skin_reference.h"
#include "tests/files.h"
#include "tests/host/lod_cases.h"
#include "tests/host/mesh_poses.h"
#include "tests/shared.h"
#include "tools/creatures/creature.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <span>

namespace throng::test {
namespace {

// Broken exporters write such meshes: the corners of all triangles are at one place.
TEST(Lod, AMeshAtOnePlaceHasNoLevels) {
    Asset asset;
    asset.name = "a point";
    asset.nodes.resize(1);
    AssetPrimitive primitive;
    primitive.positions.resize(3000);
    for (uint32_t vertex = 0; vertex < 3000; ++vertex) primitive.indices.push_back(vertex);
    asset.meshes.push_back({.primitives = {primitive}});
    asset.mesh_instances.push_back({.node = 0, .mesh = 0});
    const Result<Character> character = compile_character(asset);
    ASSERT_TRUE(character) << character.error().text();
    EXPECT_TRUE(character->lods.empty());
}

// Twice the triangles are twice the work, and some for each level of the index.
TEST(Lod, WorkGrowsNoFasterThanTheMesh) {
    THRONG_SKIP_WHERE_SANITIZED();
    std::vector<double> steps_per_face;
    for (const uint32_t faces : {12'500u, 100'000u}) {
        const Asset asset = *make_creature({.joint_count = 60, .level_count = 15, .face_count = faces});
        Character character = *compile_character(asset, {.error = 0, .lods = false});
        EXPECT_NEAR(static_cast<double>(character.indices.size()) / 3, faces, 0.01 * faces);
        steps_per_face.push_back(static_cast<double>(make_lods(character, poses_of(character, kLodPoses))) / faces);
        EXPECT_EQ(character.lods.size(), kLodLimit);
        std::printf("  %u faces: %.0f boxes and triangles looked at for each, in 8 poses\n", faces,
                    steps_per_face.back());
    }
    EXPECT_LE(steps_per_face[1], 150) << "most places are compared with a triangle that is known, without a search";
    EXPECT_LE(steps_per_face[1], 1.5 * steps_per_face[0]);
}

TEST(Lod, AreLeftOutIfDisabled) {
    const Asset asset = *make_creature({.joint_count = 60, .level_count = 15, .face_count = 1500});
    Character with = *compile_character(asset);
    const Character without = *compile_character(asset, {.lods = false});
    ASSERT_FALSE(with.lods.empty());
    EXPECT_TRUE(without.lods.empty());
    with.lods.clear(), with.lod_ranges.clear(), with.lod_indices.clear(), with.joint_lods.clear();
    ASSERT_EQ(with.sections.size(), without.sections.size());
    for (size_t i = 0; i < with.sections.size(); ++i) {
        const MeshSection& levelled = with.sections[i];
        const MeshSection& section = without.sections[i];
        ASSERT_EQ(levelled.own_vertex_count(), section.vertex_count);
        for (uint32_t v = 0; v < section.vertex_count; ++v)
            EXPECT_EQ(std::memcmp(&with.vertices[levelled.first_vertex + v],
                                  &without.vertices[section.first_vertex + v], sizeof(Vertex)),
                      0);
        for (uint32_t k = 0; k < section.vertex_count * section.influence_sets; ++k)
            EXPECT_EQ(std::memcmp(&with.influences[levelled.first_influences + k],
                                  &without.influences[section.first_influences + k], sizeof(Influences)),
                      0);
    }
    with.vertices = without.vertices, with.influences = without.influences, with.sections = without.sections;
    for (size_t i = 0; i < with.clips.size(); ++i) {  // the boxes hold the vertices of levels too
        Clip& clip = with.clips[i];
        for (float Vec3<float>::*axis : {&Vec3<float>::x, &Vec3<float>::y, &Vec3<float>::z}) {
            EXPECT_LE(clip.bounds_min.*axis, without.clips[i].bounds_min.*axis);
            EXPECT_GE(clip.bounds_max.*axis, without.clips[i].bounds_max.*axis);
        }
        clip.bounds_min = without.clips[i].bounds_min, clip.bounds_max = without.clips[i].bounds_max;
    }
    const std::string path = testing::TempDir() + "/without_details.throng";
    const auto bytes_of = [&](const Character& character) {
        EXPECT_TRUE(save_character(character, path));
        return read_file(path);
    };
    EXPECT_EQ(bytes_of(with), bytes_of(without)) << "all else is the same";
    std::filesystem::remove(path);
}

// Each section has the vertices of all three.
TEST(Lod, ClustersMayHaveVerticesThatNoTriangleHas) {
    Asset asset = *make_creature({.joint_count = 60, .level_count = 20, .face_count = 1500});
    std::vector<AssetPrimitive>& primitives = asset.meshes[0].primitives;
    const std::vector<uint32_t> all = primitives[0].indices;
    primitives.resize(3, primitives[0]);
    for (AssetPrimitive& primitive : primitives) primitive.indices.clear();
    for (size_t i = 0; i < all.size(); ++i) primitives[i / 3 * 9 / all.size()].indices.push_back(all[i]);
    EXPECT_GE(compile_character(asset)->lods.size(), 2u);
}

// By a creature of two sections, so that the second one's vertices move up.
TEST(Lod, MovedVerticesAreCopiesBehindTheirSection) {
    Asset asset = *make_creature({.joint_count = 60, .level_count = 15, .face_count = 1500});
    asset.meshes[0].primitives.push_back(asset.meshes[0].primitives[0]);
    for (Vec3<float>& p : asset.meshes[0].primitives[1].positions) p.x += 1;
    const Character character = *compile_character(asset);
    ASSERT_EQ(character.sections.size(), 2u);
    const std::vector<Vec3<double>> at_rest = reference_positions(character, *reference_pose(character, {}));
    for (size_t s = 0; s < 2; ++s) {
        const MeshSection& section = character.sections[s];
        ASSERT_GT(section.lod_vertex_count, 0u);
        std::vector<int> used_by(section.vertex_count);  // bits of levels
        for (size_t level = 0; level < character.lods.size(); ++level) {
            const IndexRange& range = character.lod_ranges[level * 2 + s];
            for (uint32_t k = 0; k < range.index_count; ++k)
                used_by[character.lod_indices[range.first_index + k]] |= 1 << level;
        }
        for (uint32_t v = section.own_vertex_count(); v < section.vertex_count; ++v) {
            EXPECT_TRUE(std::has_single_bit(static_cast<unsigned>(used_by[v]))) << "by one level each";
            const Vertex& vertex = character.vertices[section.first_vertex + v];
            bool is_copy = false;
            for (uint32_t own = 0; own < section.own_vertex_count() && !is_copy; ++own) {
                const Vertex& other = character.vertices[section.first_vertex + own];
                is_copy = vertex.texcoord == other.texcoord && vertex.normal_octahedral == other.normal_octahedral &&
                          std::memcmp(&character.influences[section.first_influences + v],
                                      &character.influences[section.first_influences + own], sizeof(Influences)) == 0;
            }
            EXPECT_TRUE(is_copy);
            const Vec3<double>& p = at_rest[section.first_vertex + v];
            for (double Vec3<double>::*axis : {&Vec3<double>::x, &Vec3<double>::y, &Vec3<double>::z}) {
                EXPECT_GE(p.*axis, character.bounds_min.as<double>().*axis - 1e-6 * character.size);
                EXPECT_LE(p.*axis, character.bounds_max.as<double>().*axis + 1e-6 * character.size);
            }
        }
    }
}

TEST(Lod, SmallMeshesHaveNone) {
    EXPECT_TRUE(make_character({.joint_count = 5, .vertex_count = 12}).lods.empty());
    EXPECT_TRUE(make_character({.joint_count = 5, .vertex_count = 0}).lods.empty());
}

// Vertices at random times, also in a clip's last row, are inside its bounds.
TEST(Lod, BoundsOfClipsHoldTheirPoses) {
    Random random(2);
    for (const Character& character :
         {with_lods(), make_character({.joint_count = 30, .seed = 3, .cubic = true, .morph_count = 4})}) {
        for (uint32_t clip = 0; clip < character.clips.size(); ++clip) {
            const Vec3<double> low = character.clips[clip].bounds_min.as<double>(),
                               high = character.clips[clip].bounds_max.as<double>();
            double beyond = 0;
            for (int i = 0; i < 40; ++i) {
                const ReferencePose pose = *reference_pose(
                    character, {.first = {.clip = clip,
                                          .time_s = i == 0 ? double{character.clips[clip].duration_s}
                                                           : random.between(0, character.clips[clip].duration_s),
                                          .loop = false}});
                for (const Vec3<double>& p : reference_positions(character, pose))
                    beyond = std::max(
                        {beyond, low.x - p.x, low.y - p.y, low.z - p.z, p.x - high.x, p.y - high.y, p.z - high.z});
            }
            EXPECT_LE(beyond, 0.01 * character.size) << character.name << ", clip " << clip;
            EXPECT_LE(length(high - low), 20 * character.size) << "and are not without end";
        }
    }
}

TEST(Lod, CraftedLevelsAreRefused) {
    const Character sound = with_lods();
    const std::vector<std::pair<void (*)(Character&), const char*>> wrong{
        {[](Character& c) { c.lods[1].error = c.lods[0].error / 2; }, "lods[1]"},
        {[](Character& c) { c.lods[0].error = std::numeric_limits<float>::quiet_NaN(); }, "lods[0]"},
        {[](Character& c) { c.lods.resize(kLodLimit + 1); }, "the limit is 3"},
        {[](Character& c) { c.lod_ranges.pop_back(); }, "lod ranges"},
        {[](Character& c) { c.lod_ranges[0].first_index = 3; }, "lod ranges[0]"},
        {[](Character& c) { c.lod_ranges.back().index_count += 3; }, ", but there are only "},
        {[](Character& c) { c.lod_ranges.back().index_count -= 1; }, "not a multiple of 3"},
        {[](Character& c) { c.lod_indices.push_back(0); }, "lod indices"},
        {[](Character& c) { c.lod_indices[5] = 0xFFFFFFFFu; }, "lod indices[5]"},
        {[](Character& c) { c.joint_lods.pop_back(); }, "joint lods"},
        {[](Character& c) { c.joint_lods[0] = 0; }, "joint lods[0]"},
        {[](Character& c) { c.joint_lods[3] = kLodLimit + 1; }, "joint lods[3]"},
        {[](Character& c) {
             c.skins.back().joint_count -= 1, std::fill(c.joint_lods.begin() + 1, c.joint_lods.end(), 0);
         },
         "the palette entry of a joint that rests has no replacement"},
        {[](Character& c) { c.clips[0].bounds_max.y = std::numeric_limits<float>::infinity(); }, "bounds"},
    };
    for (const auto& [spoil, what] : wrong) {
        Character character = sound;
        spoil(character);
        const Result<void> saved = save_character(character, testing::TempDir() + "/crafted.throng");
        ASSERT_FALSE(saved) << what;
        EXPECT_NE(saved.error().text().find(what), std::string::npos) << saved.error().text();
    }
}

}  // namespace
}  // namespace throng::test
