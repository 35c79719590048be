// Fitting a level of detail to the fine mesh: the surfaces compared, against an exhaustive search, and vertices moved.
#include "compile/mesh/fit_vertices.h"
#include "compile/mesh/surface_comparison.h"
#include "tests/host/mesh_poses.h"
#include "tests/test_rig.h"
#include "tools/creatures/creature.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <set>
#include <span>
#include <utility>
#include <vector>

namespace throng::test {
namespace {

Character creature_without_levels() {
    return *compile_character(*make_creature({.joint_count = 30, .level_count = 10, .face_count = 600}),
                              {.lods = false});
}

constexpr uint32_t kPoses = 5;  // beside the rest pose

// A character's mesh in poses, and every third triangle of it as the coarse mesh.
struct Meshes {
    explicit Meshes(Character of = creature_without_levels()) : character(std::move(of)) {}

    Character character;
    std::vector<uint32_t> indices = joined(1), sparse = joined(3);
    ThreadPool threads{1};
    PosedMesh fine{character, poses_of(character, kPoses), indices, threads, {}};
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
                     const std::function<Vec3<float>(uint32_t)>& position) {
    float nearest = std::numeric_limits<float>::infinity();
    for (size_t k = 0; k < indices.size(); k += 3)
        nearest = std::min(nearest, squared_distance(place, {position(indices[k]), position(indices[k + 1]),
                                                             position(indices[k + 2])}));
    return std::sqrt(nearest);
}

// [places]: the distances of all places of both surfaces in a pose, by their numbers.
std::vector<float> all_distances(const Meshes& of, const SurfaceComparison& comparison, uint32_t pose) {
    const auto of_coarse = [&](uint32_t vertex) { return of.coarse.position(vertex, pose); };
    const auto of_fine = [&](uint32_t vertex) { return of.fine.positions[pose][vertex]; };
    std::vector<float> distances;
    for (uint32_t point = 0; point < of.welded.point_count(); ++point)
        distances.push_back(
            nearest_of_all(of.welded.places(point)[pose / kLanes].at(pose % kLanes), of.coarse.indices(), of_coarse));
    for (const CoarseMesh::Place& place : comparison.coarse_places())
        distances.push_back(
            nearest_of_all(of.coarse.positions(place, pose / kLanes).at(pose % kLanes), of.indices, of_fine));
    return distances;
}

TEST(SurfaceComparison, FindsTheLargestDistanceAndAllPairsNearItHoweverThePointsMove) {
    Meshes of;
    ASSERT_GT(of.fine.pose_count(), kLanes) << "more than one group";
    SurfaceComparison comparison(of.coarse);
    const float rounding = 1e-5f * of.character.size;
    Random random(3);
    for (const float moved : {0.0f, 0.001f, 0.01f, 0.1f, 0.0f}) {
        of.coarse.move(of.random_shifts(random, moved));
        std::vector<std::vector<float>> wanted;  // [poses][places]
        for (uint32_t pose = 0; pose < of.fine.pose_count(); ++pose)
            wanted.push_back(all_distances(of, comparison, pose));
        float largest = 0;
        for (const std::vector<float>& in_pose : wanted) largest = std::max(largest, std::ranges::max(in_pose));
        for (const float part : {0.3f, 0.8f}) {
            const auto [found, pairs] = comparison.compare(part, 0, {});
            EXPECT_GT(found, 0.01f * of.character.size);
            EXPECT_NEAR(found, largest, rounding);
            std::set<std::pair<uint32_t, size_t>> known;
            for (const PlacePair& pair : pairs) {
                ASSERT_TRUE(known.emplace(pair.pose, pair.number).second) << "twice";
                float furthest = 0;
                for (const std::vector<float>& in_pose : wanted) furthest = std::max(furthest, in_pose[pair.number]);
                const float apart = length(pair.apart);
                ASSERT_GT(apart, part * found);
                ASSERT_GE(apart, wanted[pair.pose][pair.number] - rounding);
                ASSERT_LE(apart, std::min(1.1f * furthest, largest) + rounding);
            }
            for (uint32_t pose = 0; pose < of.fine.pose_count(); ++pose)
                for (size_t number = 0; number < wanted[pose].size(); ++number)
                    ASSERT_TRUE(wanted[pose][number] <= part * found + rounding || known.contains({pose, number}));
        }
    }
}

TEST(CoarseMesh, MovedPointsAreSkinnedLikeTheVerticesThatTheyComeFrom) {
    Meshes of(make_character({.joint_count = 10}));  // with another bind space for each joint
    Random random(5);
    of.coarse.move(of.random_shifts(random, 0.02f));
    Character moved = of.character;
    for (uint32_t vertex = 0; vertex < of.coarse.sources().size(); ++vertex)
        moved.vertices[of.coarse.sources()[vertex]].position = of.coarse.bind_position(vertex);
    const PosedMesh skinned(moved, poses_of(moved, kPoses), of.indices, of.threads, {});
    size_t moved_count = 0;
    for (uint32_t pose = 0; pose < of.fine.pose_count(); ++pose)
        for (uint32_t vertex = 0; vertex < of.coarse.sources().size(); ++vertex) {
            const Vec3<float> wanted = skinned.positions[pose][of.coarse.sources()[vertex]];
            ASSERT_LE(length(of.coarse.position(vertex, pose) - wanted), 1e-5f * of.character.size);
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
    const PosedMesh fine(character, poses_of(character, 0), indices, threads, {});
    const WeldedMesh welded(character, indices, fine.positions);
    CoarseMesh coarse(character, fine, welded, coarse_indices);
    const float before = SurfaceComparison(coarse).compare(1, 0, {}).largest;
    EXPECT_NEAR(before, 1 - std::cos(3.14159265f / 8), 2e-3f) << "the sagitta of an eighth";
    const FittedLevel fitted = fit_vertices(std::move(coarse), {});
    EXPECT_LE(fitted.error, 0.65f * before) << "half of it is the least";
    EXPECT_NEAR(SurfaceComparison(fitted.mesh).compare(1, 0, {}).largest, fitted.error, 1e-5f);
    for (uint32_t vertex = 0; vertex < fitted.mesh.sources().size(); ++vertex) {
        const Vec3<float> p = fitted.mesh.position(vertex, 0);
        EXPECT_GT(std::hypot(p.x, p.y), 1.0f);
    }
}

TEST(FitVertices, WhatIsAsCloseAsCanBeStaysInPlace) {
    Meshes of;
    const FittedLevel fitted = fit_vertices({of.character, of.fine, of.welded, of.indices}, {});
    EXPECT_LE(fitted.error, 1e-6f * of.character.size);
    for (uint32_t vertex = 0; vertex < fitted.mesh.sources().size(); ++vertex)
        ASSERT_FALSE(fitted.mesh.is_moved(vertex));
}

}  // namespace
}  // namespace throng::test
