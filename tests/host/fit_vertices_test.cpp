// Fitting a level of detail to the fine mesh: the surfaces compared, against an exhaustive search, and vertices moved.
#include "compile/mesh/fit_vertices.h"
#include "compile/mesh/surface_comparison.h"
#include "tests/test_rig.h"
#include "tools/creatures/creature.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <set>

namespace throng::test {
namespace {

Character creature_without_levels() {
    return *compile_character(*make_creature({.joint_count = 30, .level_count = 10, .face_count = 600}),
                              {.lods = false});
}

// A character's mesh in poses, and every third triangle of it as the coarse mesh.
struct Meshes {
    explicit Meshes(Character of = creature_without_levels()) : character(std::move(of)) {}

    Character character;
    std::vector<uint32_t> indices = joined(1), sparse = joined(3);
    ThreadPool threads{1};
    PosedMesh fine{character, 3, indices, threads, {}};
    WeldedMesh welded{character, indices, fine.positions};
    CoarseMesh coarse{character, fine, welded, sparse};

    std::vector<uint32_t> joined(uint32_t step) const {
        std::vector<uint32_t> all;
        for (const MeshSection& section : character.sections)
            for (uint32_t k = 0; k + 2 < section.index_count; k += 3 * step)
                for (uint32_t corner = 0; corner < 3; ++corner)
                    all.push_back(section.first_vertex + character.indices[section.first_index + k + corner]);
        return all;
    }
    std::vector<Vec3<float>> random_shifts(Random& random, float size) const {
        std::vector<Vec3<float>> shifts(coarse.shifts().size());
        for (Vec3<float>& shift : shifts)
            shift = random.chance(0.5) ? Vec3<float>{} : random.direction().as<float>() * (size * character.size);
        return shifts;
    }
};

float nearest_of_all(const Vec3<float>& place, std::span<const uint32_t> indices,
                     std::span<const Vec3<float>> positions) {
    float nearest = std::numeric_limits<float>::infinity();
    for (size_t k = 0; k < indices.size(); k += 3)
        nearest = std::min(nearest, squared_distance(place, {positions[indices[k]], positions[indices[k + 1]],
                                                             positions[indices[k + 2]]}));
    return std::sqrt(nearest);
}

// The distances of all places of both surfaces in a pose, ascending.
std::vector<float> all_distances(const Meshes& of, uint32_t pose) {
    std::vector<float> distances;
    for (const uint32_t vertex : std::set(of.indices.begin(), of.indices.end()))
        distances.push_back(
            nearest_of_all(of.fine.positions[pose][vertex], of.coarse.indices(), of.coarse.positions(pose)));
    for (const CoarseMesh::Place& place : of.coarse.places())
        distances.push_back(nearest_of_all(place.in(of.coarse.positions(pose)), of.indices, of.fine.positions[pose]));
    std::ranges::sort(distances);
    return distances;
}

TEST(SurfaceComparison, FindsTheLargestDistance) {
    Meshes of;
    float largest = 0;
    for (uint32_t pose = 0; pose < of.fine.pose_count(); ++pose)
        largest = std::max(largest, all_distances(of, pose).back());
    EXPECT_GT(largest, 0.01f * of.character.size);
    EXPECT_NEAR(SurfaceComparison(of.coarse, of.fine).largest_distance({}), largest, 1e-6f * of.character.size);
}

TEST(SurfaceComparison, FindsAllPairsBeyondADistanceHoweverThePointsMove) {
    Meshes of;
    SurfaceComparison comparison(of.coarse, of.fine);
    const float rounding = 1e-5f * of.character.size;
    float distance = 0.3f * comparison.largest_distance({});
    Random random(3);
    for (const float moved : {0.0f, 0.001f, 0.01f, 0.1f, 0.0f}) {
        of.coarse.move(of.random_shifts(random, moved));
        const std::vector<PlacePair> pairs = comparison.pairs_beyond(distance, {});
        for (uint32_t pose = 0; pose < of.fine.pose_count(); ++pose) {
            std::vector<float> wanted = all_distances(of, pose), found;
            std::erase_if(wanted, [&](float one) { return one <= distance; });
            for (const PlacePair& pair : pairs)
                if (pair.pose == pose) found.push_back(length(pair.apart));
            std::ranges::sort(found);
            EXPECT_FALSE(wanted.empty());
            ASSERT_EQ(found.size(), wanted.size()) << moved;
            for (size_t i = 0; i < found.size(); ++i) ASSERT_NEAR(found[i], wanted[i], rounding) << moved;
        }
        distance *= 0.8f;
    }
}

TEST(CoarseMesh, MovedPointsAreSkinnedLikeTheVerticesThatTheyComeFrom) {
    Meshes of(make_character({.joint_count = 10}));  // with another bind space for each joint
    Random random(5);
    of.coarse.move(of.random_shifts(random, 0.02f));
    Character moved = of.character;
    for (uint32_t vertex = 0; vertex < of.coarse.sources().size(); ++vertex)
        moved.vertices[of.coarse.sources()[vertex]].position = of.coarse.bind_position(vertex);
    const PosedMesh skinned(moved, 3, of.indices, of.threads, {});
    size_t moved_count = 0;
    for (uint32_t pose = 0; pose < of.fine.pose_count(); ++pose)
        for (uint32_t vertex = 0; vertex < of.coarse.sources().size(); ++vertex) {
            const Vec3<float> wanted = skinned.positions[pose][of.coarse.sources()[vertex]];
            ASSERT_LE(length(of.coarse.positions(pose)[vertex] - wanted), 1e-5f * of.character.size);
            moved_count += of.coarse.is_moved(vertex);
        }
    EXPECT_GT(moved_count, 0u);
}

// A tube of eight sides whose corners lie on the circle of the fine one, of 64.
TEST(FitVertices, ASurfaceThatLiesInsideIsMovedOutwards) {
    constexpr uint32_t kSides = 64, kStep = 8;
    Character character = make_character({.joint_count = 1, .clip_count = 0, .vertex_count = 0});
    character.rig.rest[0] = {};
    character.sections = {{.vertex_count = 2 * kSides}};
    for (uint32_t side = 0; side < kSides; ++side) {
        const float angle = 2 * 3.14159265f * static_cast<float>(side) / kSides;
        for (const float z : {0.0f, 4.0f})
            character.vertices.push_back({.position = {std::cos(angle), std::sin(angle), z}});
    }
    character.palette = {{}};
    character.influences.assign(2 * kSides, {{1, 0, 0, 0}, {}});
    character.bounds_min = {-2, -2, 0}, character.bounds_max = {2, 2, 4}, character.size = 6;
    const auto tube = [](uint32_t step) {
        std::vector<uint32_t> indices;
        for (uint32_t side = 0; side < kSides; side += step) {
            const uint32_t a = 2 * side, b = 2 * ((side + step) % kSides);
            indices.insert(indices.end(), {a, b, a + 1, b, b + 1, a + 1});
        }
        return indices;
    };
    const std::vector<uint32_t> indices = tube(1), coarse_indices = tube(kStep);
    ThreadPool threads(1);
    const PosedMesh fine(character, 0, indices, threads, {});
    const WeldedMesh welded(character, indices, fine.positions);
    CoarseMesh coarse(character, fine, welded, coarse_indices);
    const float before = SurfaceComparison(coarse, fine).largest_distance({});
    EXPECT_NEAR(before, 1 - std::cos(3.14159265f / 8), 2e-3f) << "the sagitta of an eighth";
    const FittedLevel fitted = fit_vertices(coarse, fine, character, {});
    EXPECT_LE(fitted.error, 0.65f * before) << "half of it is the least";
    EXPECT_NEAR(SurfaceComparison(coarse, fine).largest_distance({}), fitted.error, 1e-5f);
    for (uint32_t vertex = 0; vertex < coarse.sources().size(); ++vertex) {
        const Vec3<float> p = coarse.positions(0)[vertex];
        EXPECT_GT(std::hypot(p.x, p.y), 1.0f);
    }
}

TEST(FitVertices, WhatIsAsCloseAsCanBeStaysInPlace) {
    Meshes of;
    CoarseMesh same(of.character, of.fine, of.welded, of.indices);
    const FittedLevel fitted = fit_vertices(same, of.fine, of.character, {});
    EXPECT_LE(fitted.error, 1e-6f * of.character.size);
    for (uint32_t vertex = 0; vertex < same.sources().size(); ++vertex) ASSERT_FALSE(same.is_moved(vertex));
}

}  // namespace
}  // namespace throng::test
