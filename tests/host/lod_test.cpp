// What compile_character() adds for drawing: levels of detail, and the bounds of clips.
#include "compile/file/character_file.h"
#include "compile/mesh/lod.h"
#include "compile/mesh/triangle_index.h"
#include "compile/rig/joint_lod.h"
#include "reference/reference.h"
#include "skin/skin_reference.h"
#include "tests/files.h"
#include "tests/host/mesh_poses.h"
#include "tests/shared.h"
#include "tests/test_rig.h"
#include "tools/creatures/creature.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>

#include <cstdio>
#include <cstring>
#include <filesystem>
#include <span>

namespace throng::test {
namespace {

Character with_lods() {
    return *compile_character(*make_creature({.joint_count = 60, .level_count = 15, .face_count = 1500}));
}

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

// A strip that is flat at rest, where a few triangles are as good as many, and rolled up by a clip.
Asset make_strip() {
    constexpr uint32_t kColumns = 33, kRows = 5;
    Asset asset{.name = "strip"};
    asset.nodes = {{.name = "root"}, {.name = "middle", .parent = 0, .parent_from_node = {.translation = {1, 0, 0}}}};
    asset.skins = {{.name = "skin",
                    .joints = {0, 1},
                    .inverse_binds = {Affine{}, to_affine(Trs<float>{.translation = {-1, 0, 0}})}}};
    AssetPrimitive strip{.influence_count = 4};
    for (uint32_t row = 0; row < kRows; ++row) {
        for (uint32_t column = 0; column < kColumns; ++column) {
            const float along = 2.0f * static_cast<float>(column) / (kColumns - 1),
                        weight = std::clamp(along - 0.5f, 0.0f, 1.0f);
            strip.positions.push_back({along, 0.1f * static_cast<float>(row), 0});
            strip.influence_joints.insert(strip.influence_joints.end(), {0, 1, 0, 0});
            strip.influence_weights.insert(strip.influence_weights.end(), {1 - weight, weight, 0, 0});
            if (row + 1 == kRows || column + 1 == kColumns) continue;
            const uint32_t at = row * kColumns + column;
            for (const uint32_t step : {0u, 1u, kColumns, kColumns, 1u, kColumns + 1})
                strip.indices.push_back(at + step);
        }
    }
    asset.meshes = {{.name = "strip", .primitives = {strip}}};
    asset.mesh_instances = {{.node = 0, .mesh = 0, .skin = 0}};
    const Quaternion<float> bent = axis_angle(Vec3<float>{0, 1, 0}, 2.0f);
    asset.clips = {{.name = "bends",
                    .duration_s = 1,
                    .tracks = {{.node = 1,
                                .target = TrackTarget::kRotation,
                                .times_s = {0, 1},
                                .values = {0, 0, 0, 1, bent.x, bent.y, bent.z, bent.w}}}}};
    return asset;
}

// The rest pose, and poses at random times of clips, other than those that the compiler has sampled.
std::vector<ReferencePose> rest_and_random_poses(const Character& character, int count, Random& random) {
    std::vector<ReferencePose> poses{*reference_pose(character, {})};
    while (poses.size() <= static_cast<size_t>(count)) {
        const uint32_t clip = random.below(static_cast<uint32_t>(character.clips.size()));
        poses.push_back(*reference_pose(
            character, {.first = {.clip = clip, .time_s = random.between(0, character.clips[clip].duration_s)}}));
    }
    return poses;
}

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

TEST(Lod, WithoutClipsNoJointIsLeftOut) {
    Asset asset = make_strip();
    asset.clips.clear();
    const Character character = *compile_character(asset);
    ASSERT_FALSE(character.lods.empty());
    EXPECT_TRUE(character.joint_lods.empty());
    EXPECT_GT(character.lods[0].error, 0) << "or it would be drawn where there is no view";
}

// A chain of joints at rest, whose last joint has a vertex. Only `mover` moves, by `by`.
Character chain_with_one_that_moves(uint32_t joint_count, uint32_t mover, float by) {
    Character character{.clips = {{.duration_s = 1, .row_count = 1}},
                        .times_s = {0},
                        .keys = {{0, 0, 0, 1}, {0, 0, 0, 0}, {1, 1, 1, 0}, {by, 0, 0, 0}},
                        .skins = {{.joint_count = joint_count}}};
    for (uint32_t joint = 0; joint < joint_count; ++joint) {
        character.rig.parents.push_back(joint - 1);  // of the root: kNone
        character.rig.rest.emplace_back();
        character.palette.push_back({.joint = joint});
    }
    character.tracks.assign(2 * size_t{joint_count}, {.rotation = 0, .translation = 1, .scale = 2});
    character.tracks[mover].translation = 3;
    character.vertices.resize(1);
    character.influences = {{.weights = {1, 0, 0, 0}, .entries = {static_cast<uint16_t>(joint_count - 1)}}};
    character.sections = {{.vertex_count = 1}};
    character.lods = {{1}, {10}};
    return character;
}

TEST(Lod, JointsOfDeepChainsAreWeighedInOneWalk) {
    constexpr uint32_t kJoints = kSanitized ? 5'000 : 20'000;
    Character far = chain_with_one_that_moves(kJoints, kJoints - 1, 4),
              near = chain_with_one_that_moves(kJoints, kJoints - 1, 0.25f),
              middle = chain_with_one_that_moves(kJoints, kJoints / 2, 4);
    make_joint_lods(far);
    EXPECT_EQ(std::ranges::count(far.joint_lods, 1u), kJoints - 1) << "in the second level none but the root moves";
    EXPECT_EQ(far.joint_lods[0], 2u);
    EXPECT_EQ(far.lods[0].error, 1);
    EXPECT_EQ(far.lods[1].error, 14) << "that of the surface, and of the joint that does not move";
    make_joint_lods(near);
    EXPECT_EQ(std::ranges::count(near.joint_lods, 0u), kJoints - 1);
    EXPECT_EQ(near.lods[0].error, 1.25f);
    make_joint_lods(middle);
    EXPECT_EQ(std::ranges::count(middle.joint_lods, 1u), kJoints / 2) << "those below it rest";
}

// Like a jaw that moves in only one of many clips, and is still in the middle of that clip.
TEST(Lod, JointsThatMoveOnlyEarlyAndLateInOneClipMove) {
    constexpr uint32_t kJoints = 3, kClips = 40, kMoving = 7;
    Character character = chain_with_one_that_moves(kJoints, kJoints - 1, 0);
    const JointTracks still = character.tracks[0];
    character.tracks.assign((kClips + 1) * kJoints, still);
    character.tracks[kMoving * kJoints + kJoints - 1].translation = kTrackAnimated | 3;
    character.keys.resize(3);
    for (const float by : {0.0f, 4.0f, 0.0f, 0.0f, 4.0f, 0.0f}) character.keys.push_back({by, 0, 0, 0});
    character.times_s = {0, 0.15f, 0.3f, 0.7f, 0.85f, 1};
    character.clips.assign(kClips, character.clips[0]);
    character.clips[kMoving].row_count = 6;
    character.clips[kMoving].row_stride = 1;
    make_joint_lods(character);
    EXPECT_EQ(character.joint_lods, (std::vector<uint32_t>{2, 1, 1})) << "all, or the last joint would stop at once";
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

// With only a level's joints, a skinned vertex stays within a third of the level's error of its position with all
// joints, in the rest pose and at random times of clips.
TEST(Lod, JointsOfALevelAreEnoughForIt) {
    const Character character = with_lods();
    const uint32_t joint_count = character.rig.joint_count();
    ASSERT_EQ(character.joint_lods.size(), joint_count);
    Random random(5);
    uint32_t count_before = joint_count;
    for (uint32_t lod = 1; lod <= character.lods.size(); ++lod) {
        Character reduced = character;
        reduced.influences = influences_of_lod(character, lod);
        uint32_t count = 0;
        for (uint32_t joint = 0; joint < joint_count; ++joint) {
            const uint32_t parent = character.rig.parents[joint];
            ASSERT_LE(character.joint_lods[joint],
                      parent == kNone ? character.lods.size() : character.joint_lods[parent]);
            count += character.joint_lods[joint] >= lod;
        }
        for (const Influences& influences : reduced.influences)
            for (const uint16_t entry : influences.entries)
                ASSERT_GE(character.joint_lods[character.palette[entry].joint], lod);
        double furthest = 0;
        for (const ReferencePose& pose : rest_and_random_poses(character, 29, random)) {
            const std::vector<Vec3<double>> all = skin_reference(character, pose.model_from_bind),
                                            some = skin_reference(reduced, pose.model_from_bind);
            for (size_t vertex = 0; vertex < all.size(); ++vertex)
                furthest = worse_of(furthest, length(all[vertex] - some[vertex]));
        }
        EXPECT_LE(furthest, 1.1 / 3 * character.lods[lod - 1].error);
        EXPECT_LE(count, count_before);
        std::printf("  level %u: %u of %u joints, a vertex moves by %.1e of the size; the mesh by %.1e\n", lod, count,
                    joint_count, furthest / character.size, character.lods[lod - 1].error / character.size);
        count_before = count;
    }
    EXPECT_LT(count_before, joint_count / 2);
    EXPECT_EQ(influences_of_lod(character, 0).size(), character.influences.size());
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
