// How far levels of detail are from the fine mesh, measured by other means than the compiler's.
#include "compile/mesh/triangle_index.h"
#include "reference/reference.h"
#include "tests/files.h"
#include "tests/host/lod_cases.h"
#include "tests/host/mesh_poses.h"
#include "tests/shared.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cstdio>
#include <filesystem>
#include <span>

namespace throng::test {
namespace {

// The distance of a point from a triangle, by projecting onto the plane and the edges (C. Ericson, Real-Time Collision
// Detection, 2005, 5.1.5).
double distance_to_face(const Vec3<double>& p, const std::array<Vec3<double>, 3>& t) {
    const Vec3<double> normal = cross(t[1] - t[0], t[2] - t[0]);
    const double squared = dot(normal, normal);
    double nearest = 1e300;
    bool inside = squared > 0;
    for (size_t k = 0; k < 3; ++k) {
        const Vec3<double> a = t[k], edge = t[(k + 1) % 3] - a;
        inside = inside && dot(cross(edge, p - a), normal) >= 0;
        const double length_squared = dot(edge, edge),
                     at = length_squared > 0 ? std::clamp(dot(p - a, edge) / length_squared, 0.0, 1.0) : 0;
        nearest = std::min(nearest, length(p - (a + edge * at)));
    }
    return inside ? std::abs(dot(p - t[0], normal)) / std::sqrt(squared) : nearest;
}

struct Face {
    std::array<Vec3<double>, 3> corners;
    double radius = 0;  // about the first corner; a quick test that most faces are too far away
};

// The distance of the farthest of some points from a mesh. A point is dropped once a face is found nearer than the
// farthest distance so far. The previous point's nearest face is tried first, since neighbours often share it.
class FurthestFromMesh {
public:
    explicit FurthestFromMesh(std::span<const Face> mesh) : mesh_(mesh) {}

    void add(const Vec3<double>& p) {
        double nearest = mesh_.empty() ? 1e300 : distance_to_face(p, mesh_[near_].corners);
        for (size_t i = 0; i < mesh_.size() && nearest > furthest_; ++i) {
            const Face& face = mesh_[i];
            if (length(p - face.corners[0]) - face.radius >= nearest) continue;
            const double distance = distance_to_face(p, face.corners);
            if (distance >= nearest) continue;
            nearest = distance;
            near_ = i;
        }
        furthest_ = worse_of(furthest_, nearest);
    }
    double furthest() const { return furthest_; }

private:
    std::span<const Face> mesh_;
    size_t near_ = 0;
    double furthest_ = 0;
};

std::vector<Face> triangles_of(std::span<const uint32_t> indices, std::span<const Vec3<double>> positions) {
    std::vector<Face> triangles(indices.size() / 3);
    for (size_t k = 0; k < indices.size(); ++k) triangles[k / 3].corners[k % 3] = positions[indices[k]];
    for (Face& face : triangles) {
        const auto& [a, b, c] = face.corners;
        face.radius = std::max(length(b - a), length(c - a));
    }
    return triangles;
}

// The largest distance from vertices of the finest level to the surface of the given level, which may be skinned by
// fewer joints, and from the level's triangles (their corners, centres and edge midpoints) to the finest.
double furthest_from_level(const Character& character, size_t level, const ReferencePose& pose) {
    Character reduced = character;
    reduced.influences = influences_of_lod(character, static_cast<uint32_t>(level + 1));
    const std::vector<Vec3<double>> fine = reference_positions(character, pose),
                                    coarse = reference_positions(reduced, pose);
    double furthest = 0;
    for (size_t i = 0; i < character.sections.size(); ++i) {
        const MeshSection& section = character.sections[i];
        const IndexRange& range = character.lod_ranges[level * character.sections.size() + i];
        const auto of_section = [&](std::span<const Vec3<double>> all) {
            return all.subspan(section.first_vertex, section.vertex_count);
        };
        const std::vector<Face> coarse_mesh = triangles_of(
            std::span(character.lod_indices).subspan(range.first_index, range.index_count), of_section(coarse));
        const std::vector<Face> fine_mesh = triangles_of(
            std::span(character.indices).subspan(section.first_index, section.index_count), of_section(fine));
        FurthestFromMesh from_coarse(coarse_mesh), from_fine(fine_mesh);
        for (const Vec3<double>& vertex : of_section(fine).first(section.own_vertex_count())) from_coarse.add(vertex);
        for (const Face& face : coarse_mesh) {
            const auto& [a, b, c] = face.corners;
            for (const Vec3<double>& place :
                 {a, b, c, (a + b + c) * (1 / 3.0), (a + b) * 0.5, (b + c) * 0.5, (c + a) * 0.5})
                from_fine.add(place);
        }
        furthest = worse_of(furthest, worse_of(from_coarse.furthest(), from_fine.furthest()));
    }
    return furthest;
}

TEST(Lod, LevelsHaveFewerTrianglesWithinTheirErrors) {
    for (const Character& character : {with_lods(), *compile_character(make_strip())}) {
        ASSERT_GE(character.lods.size(), 2u);
        ASSERT_EQ(character.lod_ranges.size(), character.lods.size() * character.sections.size());
        Random random(7);
        const std::vector<ReferencePose> poses = rest_and_random_poses(character, 8, random);
        size_t before = character.indices.size();
        for (size_t level = 0; level < character.lods.size(); ++level) {
            size_t count = 0;
            for (size_t i = 0; i < character.sections.size(); ++i) {
                const IndexRange& range = character.lod_ranges[level * character.sections.size() + i];
                count += range.index_count;
                ASSERT_EQ(range.index_count % 3, 0u);
                for (uint32_t k = 0; k < range.index_count; ++k)
                    ASSERT_LT(character.lod_indices[range.first_index + k], character.sections[i].vertex_count);
            }
            EXPECT_LE(count, before * 4 / 5);
            before = count;
            const double error = character.lods[level].error;
            EXPECT_GE(error, level > 0 ? character.lods[level - 1].error : 1e-7 * character.size);
            const double at_rest = furthest_from_level(character, level, poses[0]);
            double furthest = at_rest;
            for (const ReferencePose& pose : std::span(poses).subspan(1))
                furthest = std::max(furthest, furthest_from_level(character, level, pose));
            EXPECT_LE(furthest, 1.1 * error);
            const bool is_none = error <= 1.1e-6 * character.size;  // lod.cpp: kRounding
            EXPECT_TRUE(is_none || furthest >= 0.3 * error) << "and not much less: " << furthest << " of " << error;
            std::printf(
                "  %s, level %zu: %zu of %zu triangles, error %.1e of the size, furthest vertex %.1e, at rest %.1e\n",
                character.name.c_str(), level + 1, count / 3, character.indices.size() / 3, error / character.size,
                furthest / character.size, at_rest / character.size);
        }
    }
}

// Every triangle has its own vertices, at shared positions, so that no edge can be collapsed.
AssetPrimitive in_pieces(const AssetPrimitive& whole) {
    AssetPrimitive pieces{.influence_count = 4};
    for (const uint32_t index : whole.indices) {
        pieces.indices.push_back(static_cast<uint32_t>(pieces.positions.size()));
        pieces.positions.push_back(whole.positions[index]);
        pieces.colors.push_back({static_cast<float>(pieces.positions.size() % 251) / 250,
                                 static_cast<float>(pieces.positions.size() / 251) / 16, 0, 1});
        for (uint32_t k = 0; k < 4; ++k) {
            pieces.influence_joints.push_back(whole.influence_joints[index * 4 + k]);
            pieces.influence_weights.push_back(whole.influence_weights[index * 4 + k]);
        }
    }
    return pieces;
}

TEST(Lod, AMeshInPiecesHasLevels) {
    Asset asset = make_strip();
    asset.meshes[0].primitives[0] = in_pieces(asset.meshes[0].primitives[0]);
    const Character character = *compile_character(asset);
    ASSERT_EQ(character.indices.size(), 256u * 3);
    ASSERT_GE(character.lods.size(), 2u);
    EXPECT_LE(character.lod_ranges[0].index_count, 256u * 3 * 2 / 5);
    const ReferencePose rest = *reference_pose(character, {});
    for (size_t level = 0; level < character.lods.size(); ++level) {
        EXPECT_LE(furthest_from_level(character, level, rest), 1.01 * character.lods[level].error);
        EXPECT_LT(character.lods[level].error, 0.2f * character.size);
    }
}

// A single tetrahedron cannot be decimated. Of many, clustering vertices leaves the larger ones.
TEST(Lod, AMeshOfManySmallPiecesHasLevels) {
    AssetPrimitive pieces;
    for (uint32_t i = 0; i < 400; ++i) {
        const Vec3<float> from{static_cast<float>(i % 20), static_cast<float>(i / 20), 0};
        const auto at = static_cast<uint32_t>(pieces.positions.size());
        const float size = static_cast<float>(1 + i % 9) / 10;
        for (const Vec3<float>& way : {Vec3<float>{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}})
            pieces.positions.push_back(from + way * size);
        for (const uint32_t step : {0u, 2u, 1u, 0u, 1u, 3u, 0u, 3u, 2u, 1u, 2u, 3u})
            pieces.indices.push_back(at + step);
    }
    const Character character = *compile_character({.name = "pieces",
                                                    .nodes = {{.name = "root"}},
                                                    .meshes = {{.name = "pieces", .primitives = {pieces}}},
                                                    .mesh_instances = {{.node = 0, .mesh = 0}}});
    ASSERT_FALSE(character.lods.empty());
    EXPECT_LE(character.lod_ranges[0].index_count, character.indices.size() / 2);
    EXPECT_LE(furthest_from_level(character, 0, *reference_pose(character, {})), 1.01 * character.lods[0].error);
}

// Two strips that are adjacent at rest and moved apart by a clip: a triangle of a cluster of both would be as wide as
// the gap.
TEST(Lod, PartsThatAClipSeparatesAreNotJoined) {
    Asset asset = make_strip();
    AssetPrimitive& both = asset.meshes[0].primitives[0];
    const size_t count = both.positions.size(), index_count = both.indices.size();
    for (size_t i = 0; i < count; ++i) {
        both.positions.push_back(both.positions[i] + Vec3<float>{0, 0.42f, 0});
        both.influence_joints.insert(both.influence_joints.end(), {0, 1, 0, 0});
        both.influence_weights.insert(both.influence_weights.end(), {0, 1, 0, 0});
        for (size_t k = 0; k < 4; ++k) both.influence_weights[i * 4 + k] = k == 0 ? 1.0f : 0.0f;
    }
    for (size_t k = 0; k < index_count; ++k) both.indices.push_back(both.indices[k] + static_cast<uint32_t>(count));
    both = in_pieces(both);
    asset.clips = {
        {.name = "parts",
         .duration_s = 1,
         .tracks = {
             {.node = 1, .target = TrackTarget::kTranslation, .times_s = {0, 1}, .values = {1, 0, 0, 1, 3, 0}}}}};
    const Character character = *compile_character(asset);
    const ReferencePose apart = *reference_pose(character, {.first = {.clip = 0, .time_s = 0.9}});
    ASSERT_FALSE(character.lods.empty());
    for (size_t level = 0; level < character.lods.size(); ++level)
        EXPECT_LE(furthest_from_level(character, level, apart), 1.1 * character.lods[level].error)
            << "level " << level + 1;
}

// A static rock of 2 * 150 * 150 triangles.
Asset make_rock() {
    constexpr uint32_t kSides = 150;
    Random random(3);
    AssetPrimitive rock;
    for (uint32_t row = 0; row <= kSides; ++row)
        for (uint32_t column = 0; column < kSides; ++column) {
            const double turn = 6.2831853 * column / kSides, down = 3.14159265 * row / kSides;
            const double swelling = std::sin(5 * turn) * std::sin(down) * std::cos(4 * down);
            const Vec3<double> outward{std::sin(down) * std::cos(turn), std::cos(down),
                                       std::sin(down) * std::sin(turn)};
            rock.positions.push_back((outward * (1 + 0.2 * swelling + 0.03 * random.unit())).as<float>());
            if (row == kSides) continue;
            const uint32_t at = row * kSides + column, beside = row * kSides + (column + 1) % kSides;
            rock.indices.insert(rock.indices.end(), {at, beside, at + kSides, beside, beside + kSides, at + kSides});
        }
    return {.name = "rock",
            .nodes = {{.name = "rock"}},
            .meshes = {{.name = "rock", .primitives = {rock}}},
            .mesh_instances = {{.node = 0, .mesh = 0}}};
}

// The largest distance of these places from the mesh.
double furthest_place(std::span<const Vec3<float>> places, const TriangleIndex& mesh) {
    float furthest = 0;
    uint32_t guess = 0;
    for (const Vec3<float>& place : places) {
        const TriangleIndex::Nearest found = mesh.nearest(place, furthest, guess);
        furthest = std::max(furthest, found.squared_distance);
        guess = found.triangle;
    }
    return std::sqrt(furthest);
}

std::vector<Vec3<float>> in_single_precision(std::span<const Vec3<double>> places) {
    std::vector<Vec3<float>> all;
    for (const Vec3<double>& place : places) all.push_back(place.as<float>());
    return all;
}

TEST(Lod, LargeMeshesAreMeasuredAtEveryVertex) {
    const Character character = *compile_character(make_rock(), kExact);
    ASSERT_EQ(character.indices.size(), 45'000u * 3);
    ASSERT_EQ(character.lods.size(), kLodLimit);
    const std::vector<Vec3<float>> positions = in_single_precision(
        reference_positions(character, *reference_pose(character, {})));
    const TriangleIndex fine(character.indices, positions);
    for (size_t level = 0; level < kLodLimit; ++level) {
        const IndexRange& range = character.lod_ranges[level];
        const auto indices = std::span(character.lod_indices).subspan(range.first_index, range.index_count);
        std::vector<Vec3<float>> places;
        for (size_t k = 0; k < indices.size(); k += 3) {
            const Vec3<float>&a = positions[indices[k]], &b = positions[indices[k + 1]], &c = positions[indices[k + 2]];
            places.insert(places.end(),
                          {a, b, c, (a + b + c) * (1 / 3.0f), (a + b) * 0.5f, (b + c) * 0.5f, (c + a) * 0.5f});
        }
        const auto own = std::span(positions).first(character.sections[0].own_vertex_count());
        const double furthest = std::max(furthest_place(own, TriangleIndex(indices, positions)),
                                         furthest_place(places, fine));
        EXPECT_LE(furthest, double{character.lods[level].error}) << "level " << level + 1;
        EXPECT_GE(furthest, 0.999 * double{character.lods[level].error}) << "level " << level + 1;
    }
}

// Checked in poses few of which the compiler has sampled.
TEST(Lod, OfSharedCharactersAreCloseAtAThirdOfTheirTriangles) {
    const std::filesystem::path folder = shared_folder("characters");
    if (!std::filesystem::exists(folder)) GTEST_SKIP() << "there is no " << folder;
    const std::vector<std::pair<const char*, double>> known{
        {"cesium_man/CesiumMan.glb", 0.02},
        {"fox/Fox.glb", 0.02},
        {"greenman/greenman.glb", 0.02},
        {"hand_right_cubic/rightHandHigh.glb", 0.02},
        {"kaykit_knight/Knight.glb", 0.02},
        {"mannequiny/mannequiny-0.3.0.glb", 0.02},
        {"rigged_simple/rigged_simple.gltf", 0.02},
        {"robot_expressive/RobotExpressive.glb", 0.02},
        {"tnua_player/player.glb", 0.02},
    };
    for (const auto& [file, most] : known) {
        const Character character = *compile_character(*load_asset(folder / file), kExact);
        ASSERT_FALSE(character.lods.empty()) << file;
        std::vector<uint32_t> fine, coarse;  // the character's vertices
        for (size_t i = 0; i < character.sections.size(); ++i) {
            const MeshSection& section = character.sections[i];
            const IndexRange& range = character.lod_ranges[i];
            for (uint32_t k = 0; k < section.index_count; ++k)
                fine.push_back(section.first_vertex + character.indices[section.first_index + k]);
            for (uint32_t k = 0; k < range.index_count; ++k)
                coarse.push_back(section.first_vertex + character.lod_indices[range.first_index + k]);
        }
        EXPECT_LE(3 * coarse.size(), fine.size()) << file;
        EXPECT_LE(character.lods[0].error, most * character.size) << file;
        Character reduced = character;
        reduced.influences = influences_of_lod(character, 1);
        Random random(11);
        double furthest = 0;
        for (const ReferencePose& pose : rest_and_random_poses(character, 5, random)) {
            const std::vector<Vec3<float>> fine_places = in_single_precision(reference_positions(character, pose)),
                                           places = in_single_precision(reference_positions(reduced, pose));
            std::vector<Vec3<float>> vertices, middles;
            for (const uint32_t vertex : fine) vertices.push_back(fine_places[vertex]);
            for (size_t k = 0; k < coarse.size(); k += 3)
                middles.push_back((places[coarse[k]] + places[coarse[k + 1]] + places[coarse[k + 2]]) * (1 / 3.0f));
            furthest = std::max({furthest, furthest_place(vertices, TriangleIndex(coarse, places)),
                                 furthest_place(middles, TriangleIndex(fine, fine_places))});
        }
        std::printf("  %-34s %5zu of %5zu triangles, off by %.2f %%, by %.2f in poses that were not looked at\n", file,
                    coarse.size() / 3, fine.size() / 3, 100 * double{character.lods[0].error / character.size},
                    100 * furthest / double{character.size});
        EXPECT_LE(furthest, 1.25 * most * double{character.size}) << file;
    }
}

}  // namespace
}  // namespace throng::test
