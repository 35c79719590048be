// What compile_character() adds for the draw: coarser meshes, and how far clips take the mesh.
#include "bind/bind_reference.h"
#include "compile/character_file.h"
#include "crowd/reference.h"
#include "sample/sample_reference.h"
#include "skin/skin_reference.h"
#include "tests/crowd_cases.h"

#include <gtest/gtest.h>

#include <cstdio>

namespace throng::test {
namespace {

Character detailed() { return *compile_character(*make_creature({.joint_count = 60, .level_count = 15, .face_count = 1500})); }

// Of the point from the triangle; C. Ericson, Real-Time Collision Detection, 2005, 5.1.5, by projecting onto the plane and the edges.
double distance_to_triangle(const Vec3<double>& p, const std::array<Vec3<double>, 3>& t) {
    const Vec3<double> normal = cross(t[1] - t[0], t[2] - t[0]);
    const double squared = dot(normal, normal);
    double nearest = 1e300;
    bool inside = squared > 0;
    for (size_t k = 0; k < 3; ++k) {
        const Vec3<double> a = t[k], edge = t[(k + 1) % 3] - a;
        inside = inside && dot(cross(edge, p - a), normal) >= 0;
        const double length_squared = dot(edge, edge), at = length_squared > 0 ? std::clamp(dot(p - a, edge) / length_squared, 0.0, 1.0) : 0;
        nearest = std::min(nearest, length(p - (a + edge * at)));
    }
    return inside ? std::abs(dot(p - t[0], normal)) / std::sqrt(squared) : nearest;
}

TEST(Detail, LevelsHaveFewerTrianglesOfTheSameVertices) {
    const Character character = detailed();
    ASSERT_GE(character.details.size(), 2u);
    ASSERT_EQ(character.detail_ranges.size(), character.details.size() * character.sections.size());
    size_t before = character.indices.size();
    const std::vector<Vec3<double>> rest = skin_reference(character, reference_pose(character, {})->model_from_bind);
    for (size_t level = 0; level < character.details.size(); ++level) {
        size_t count = 0;
        double furthest = 0;  // of a vertex of the finest mesh from the level's surface
        for (size_t i = 0; i < character.sections.size(); ++i) {
            const MeshSection& section = character.sections[i];
            const IndexRange& range = character.detail_ranges[level * character.sections.size() + i];
            count += range.index_count;
            ASSERT_EQ(range.index_count % 3, 0u);
            std::vector<std::array<Vec3<double>, 3>> triangles;
            for (uint32_t k = 0; k < range.index_count; k += 3) {
                std::array<Vec3<double>, 3>& triangle = triangles.emplace_back();
                for (uint32_t corner = 0; corner < 3; ++corner) {
                    const uint32_t vertex = character.detail_indices[range.first_index + k + corner];
                    ASSERT_LT(vertex, section.vertex_count);
                    triangle[corner] = rest[section.first_vertex + vertex];
                }
            }
            for (uint32_t k = 0; k < section.index_count; ++k) {
                double nearest = 1e300;
                for (const auto& triangle : triangles) nearest = std::min(nearest, distance_to_triangle(rest[section.first_vertex + character.indices[section.first_index + k]], triangle));
                furthest = std::max(furthest, nearest);
            }
        }
        EXPECT_LE(count, before * 4 / 5);
        EXPECT_GE(character.details[level].error, level > 0 ? character.details[level - 1].error : 0);
        EXPECT_NEAR(furthest, character.details[level].error, 1e-5 * character.size);
        EXPECT_LE(furthest, 0.2 * character.size);
        std::printf("  level %zu: %zu of %zu triangles, error %.1e of the size, furthest vertex %.1e\n", level + 1, count / 3, character.indices.size() / 3, character.details[level].error / character.size, furthest / character.size);
        before = count;
    }
}

TEST(Detail, SmallMeshesHaveNone) {
    EXPECT_TRUE(make_character({.joint_count = 5, .vertex_count = 12}).details.empty());
    EXPECT_TRUE(make_character({.joint_count = 5, .vertex_count = 0}).details.empty());
}

// Vertices at random times, also of a clip's last row, lie within its bounds.
TEST(Detail, BoundsOfClipsHoldTheirPoses) {
    Random random(2);
    for (const Character& character : {detailed(), make_character({.joint_count = 30, .seed = 3, .cubic = true, .morph_count = 4})}) {
        for (uint32_t clip = 0; clip < character.clips.size(); ++clip) {
            const Vec3<double> low = character.clips[clip].bounds_min.as<double>(), high = character.clips[clip].bounds_max.as<double>();
            double beyond = 0;
            for (int i = 0; i < 40; ++i) {
                const ReferencePose pose = *reference_pose(character, {.first = {.clip = clip, .time_s = i == 0 ? double{character.clips[clip].duration_s} : random.between(0, character.clips[clip].duration_s), .loop = false}});
                for (const Vec3<double>& p : reference_positions(character, pose))
                    beyond = std::max({beyond, low.x - p.x, low.y - p.y, low.z - p.z, p.x - high.x, p.y - high.y, p.z - high.z});
            }
            EXPECT_LE(beyond, 0.01 * character.size) << character.name << ", clip " << clip;
            EXPECT_LE(length(high - low), 20 * character.size) << "and are not without end";
        }
    }
}

// Skinned by the joints of a level alone, a vertex stays within the level's error of where it is with all of them, at random times of clips.
TEST(Detail, JointsOfALevelAreEnoughForIt) {
    const Character character = detailed();
    const uint32_t joint_count = character.rig.joint_count();
    ASSERT_EQ(character.joint_details.size(), joint_count);
    Random random(5);
    uint32_t count_before = joint_count;
    for (uint32_t detail = 1; detail <= character.details.size(); ++detail) {
        Character reduced = character;
        reduced.influences = influences_of_detail(character, detail);
        uint32_t count = 0;
        for (uint32_t joint = 0; joint < joint_count; ++joint) {
            const uint32_t parent = character.rig.parents[joint];
            ASSERT_LE(character.joint_details[joint], parent == kNone ? character.details.size() : character.joint_details[parent]);
            count += character.joint_details[joint] >= detail;
        }
        for (const Influences& influences : reduced.influences)
            for (const uint16_t entry : influences.entries) ASSERT_GE(character.joint_details[character.palette[entry].joint], detail);
        double furthest = 0;
        for (int i = 0; i < 30; ++i) {
            const uint32_t clip = random.below(static_cast<uint32_t>(character.clips.size()));
            const ReferencePose pose = *reference_pose(character, {.first = {.clip = clip, .time_s = random.between(0, character.clips[clip].duration_s)}});
            const std::vector<Vec3<double>> all = skin_reference(character, pose.model_from_bind), some = skin_reference(reduced, pose.model_from_bind);
            for (size_t vertex = 0; vertex < all.size(); ++vertex) furthest = std::max(furthest, length(all[vertex] - some[vertex]));
        }
        EXPECT_LE(furthest, 1.1 * character.details[detail - 1].error);
        EXPECT_LT(count, count_before);
        std::printf("  level %u: %u of %u joints, a vertex moves by %.1e of the size; the mesh by %.1e\n", detail, count, joint_count, furthest / character.size, character.details[detail - 1].error / character.size);
        count_before = count;
    }
    EXPECT_EQ(influences_of_detail(character, 0).size(), character.influences.size());
}

TEST(Detail, CraftedLevelsAreRefused) {
    const Character sound = detailed();
    const std::vector<std::pair<void (*)(Character&), const char*>> wrong{
        {[](Character& c) { c.details[1].error = c.details[0].error / 2; }, "details[1]"},
        {[](Character& c) { c.details[0].error = std::numeric_limits<float>::quiet_NaN(); }, "details[0]"},
        {[](Character& c) { c.details.resize(kDetailLimit + 1); }, "the limit is 3"},
        {[](Character& c) { c.detail_ranges.pop_back(); }, "detail ranges"},
        {[](Character& c) { c.detail_ranges[0].first_index = 3; }, "detail ranges[0]"},
        {[](Character& c) { c.detail_ranges.back().index_count += 3; }, "of " /* those that are there */},
        {[](Character& c) { c.detail_ranges.back().index_count -= 1; }, "triangles"},
        {[](Character& c) { c.detail_indices.push_back(0); }, "detail indices"},
        {[](Character& c) { c.detail_indices[5] = 0xFFFFFFFFu; }, "detail indices[5]"},
        {[](Character& c) { c.joint_details.pop_back(); }, "joint details"},
        {[](Character& c) { c.joint_details[0] = 0; }, "joint details[0]"},
        {[](Character& c) { c.joint_details[3] = kDetailLimit + 1; }, "joint details[3]"},
        {[](Character& c) { c.skins.back().joint_count -= 1, std::fill(c.joint_details.begin() + 1, c.joint_details.end(), 0); }, "stands for it"},
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
