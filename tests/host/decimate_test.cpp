// Decimating an animated mesh: how well it keeps shape, borders and textures in all poses, and how few triangles
// result.
#include "base/failure.h"
#include "base/progress.h"
#include "compile/mesh/decimate.h"
#include "compile/mesh/four_triangles.h"
#include "compile/mesh/triangle_index.h"
#include "compile/mesh/welded_mesh.h"
#include "tests/test_rig.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <utility>
#include <vector>

namespace throng::test {
namespace {

using Places = std::vector<Vec3<float>>;
using Indices = std::vector<uint32_t>;

// A mesh to decimate. The character has only what decimation needs.
struct Mesh {
    Character character{.sections = {{}}, .size = 1};
    Places rest;
    Indices indices;

    uint32_t add(const Vec3<float>& place, const std::array<float, 2>& texcoord = {}) {
        rest.push_back(place);
        character.vertices.push_back({.position = place, .texcoord = texcoord});
        ++character.sections.back().vertex_count;
        return static_cast<uint32_t>(rest.size()) - 1;
    }
    Indices decimated(size_t triangles, const std::vector<Places>& poses = {}) const {
        std::vector<Places> positions{rest};
        positions.insert(positions.end(), poses.begin(), poses.end());
        const std::array<size_t, 1> wanted{3 * triangles};
        Indices result;
        const auto take = [&](Indices made) {
            result = std::move(made);
            return false;
        };
        decimate(WeldedMesh(character, indices, positions), TriangleIndex(indices, rest), wanted, take, {});
        return result;
    }
};

// A planar grid of kSide x kSide squares with two triangles each, starting at `from`.
constexpr uint32_t kSide = 16;
void add_grid(Mesh& mesh, const Vec3<float>& from, float u) {
    const auto first = static_cast<uint32_t>(mesh.rest.size());
    for (uint32_t y = 0; y <= kSide; ++y)
        for (uint32_t x = 0; x <= kSide; ++x) {
            const float along = static_cast<float>(x) / kSide, up = static_cast<float>(y) / kSide;
            mesh.add(from + Vec3<float>{along, up, 0}, {u + 0.1f * along, up});
            if (x == kSide || y == kSide) continue;
            const uint32_t at = first + y * (kSide + 1) + x;
            for (const uint32_t step : {0u, 1u, kSide + 1, kSide + 1, 1u, kSide + 2}) mesh.indices.push_back(at + step);
        }
}

// The largest distance of these vertices from the mesh of `indices`.
float furthest(const Indices& vertices, const Indices& indices, const Places& places) {
    const TriangleIndex mesh(indices, places);
    float squared = 0;
    for (const uint32_t vertex : vertices)
        squared = std::max(squared, mesh.nearest(places[vertex], 0, 0).squared_distance);
    return std::sqrt(squared);
}

// The number of triangles at each edge.
std::map<std::pair<uint32_t, uint32_t>, int> edges_of(const Indices& indices) {
    std::map<std::pair<uint32_t, uint32_t>, int> edges;
    for (size_t k = 0; k < indices.size(); ++k) {
        const uint32_t a = indices[k], b = indices[k % 3 == 2 ? k - 2 : k + 1];
        ++edges[std::minmax(a, b)];
    }
    return edges;
}

TEST(FourTriangles, DistancesEqualThoseOfSingleTriangles) {
    Random random(1);
    const auto place = [&] { return Vec3<double>{random.unit(), random.unit(), random.unit()}.as<float>(); };
    for (int i = 0; i < 2000; ++i) {
        std::array<Triangle, kLanes> triangles;
        std::array<Vec3<float>, kLanes> points;
        std::array<Four3, 4> all{};
        for (size_t lane = 0; lane < kLanes; ++lane) {
            triangles[lane] = {place(), place(), place()};
            if (i % 4 == 1) triangles[lane][2] = triangles[lane][0];  // degenerate: as thin as a line
            if (i % 4 == 2) triangles[lane][1] = triangles[lane][2] = triangles[lane][0];
            points[lane] = place();
            if (i % 4 == 3) points[lane] = triangles[lane][0] * 0.25f + triangles[lane][1] * 0.75f;
            const std::array<Vec3<float>, 4> of_lane{triangles[lane][0], triangles[lane][1], triangles[lane][2],
                                                     points[lane]};
            for (size_t k = 0; k < 4; ++k) all[k].set(lane, of_lane[k]);
        }
        const Four squared = FourTriangles(all[0], all[1], all[2]).squared_distance(all[3]);
        for (size_t lane = 0; lane < kLanes; ++lane)
            EXPECT_NEAR(std::sqrt(squared[lane]), std::sqrt(squared_distance(points[lane], triangles[lane])), 1e-3);
    }
}

TEST(WeldedMesh, HasOnePointForVerticesThatStayTogether) {
    Mesh mesh;
    for (int i = 0; i < 3; ++i) {
        mesh.add({0, 0, 0}, {static_cast<float>(i), 0});
        mesh.add({1, 0, 0});
        mesh.add({0, 1, 0});
        for (const uint32_t k : {0u, 1u, 2u}) mesh.indices.push_back(static_cast<uint32_t>(3 * i) + k);
    }
    Places moved = mesh.rest;
    moved[6] = {0, 0, 1};  // moves away from the others
    const WeldedMesh welded(mesh.character, mesh.indices, std::array{mesh.rest, moved});
    EXPECT_EQ(welded.point_count(), 4u);
    EXPECT_EQ(welded.point_of(0), welded.point_of(3));
    EXPECT_NE(welded.point_of(0), welded.point_of(6));
    EXPECT_EQ(welded.point_of(1), welded.point_of(7));
    EXPECT_EQ(welded.groups(), 1u);
    EXPECT_EQ(welded.places(welded.point_of(6))->at(1), (Vec3<float>{0, 0, 1}));
    EXPECT_EQ(welded.places(welded.point_of(6))->at(3), (Vec3<float>{0, 0, 1})) << "the last pose again";
    EXPECT_EQ(welded.most_like(0, welded.point_of(3)).vertex, 0u);
    EXPECT_EQ(welded.most_like(3, welded.point_of(0)).vertex, 3u);
}

// Must not compare all pairs of vertices, which would take forever.
TEST(WeldedMesh, ManyVerticesAtOnePlaceAreFast) {
    Mesh mesh;
    constexpr uint32_t kVertices = 100'000, kTexcoords = 1000;
    for (uint32_t i = 0; i < kVertices; ++i) {
        mesh.add({}, {static_cast<float>(i % kTexcoords), 0});
        mesh.indices.push_back(i);
    }
    const WeldedMesh together(mesh.character, mesh.indices, std::array{mesh.rest});
    EXPECT_EQ(together.point_count(), 1u);
    EXPECT_TRUE(together.faces().empty());
    EXPECT_EQ(together.most_like(kVertices - 1, 0).vertex, kTexcoords - 1);
    EXPECT_TRUE(together.most_like(kVertices - 1, 0).is_of_same_chart);

    Places apart = mesh.rest;
    for (uint32_t i = 0; i < kVertices; ++i) apart[i].y = static_cast<float>(i / 2);
    const WeldedMesh parting(mesh.character, mesh.indices, std::array{mesh.rest, apart});
    EXPECT_EQ(parting.point_count(), kVertices / 2);
    for (uint32_t i = 0; i < kVertices; i += 2) ASSERT_EQ(parting.point_of(i), parting.point_of(i + 1));

    apart.back().x = 1e6f;  // so that the others lie together along the widest axis
    const WeldedMesh hidden(mesh.character, mesh.indices, std::array{mesh.rest, apart});
    EXPECT_GE(hidden.point_count(), kVertices / 2);
    for (uint32_t i = 0; i < 256; i += 2) ASSERT_EQ(hidden.point_of(i), hidden.point_of(i + 1));
}

// Vertices at one place at rest, a little apart in other poses: each belongs to the first one that it stays together
// with.
TEST(WeldedMesh, PointsAreThoseOfComparingAllPairs) {
    constexpr float kClose = 5e-7f;  // the character's size is 1
    Random random(7);
    uint32_t joined_count = 0, parted_count = 0;
    for (int round = 0; round < 50; ++round) {
        Mesh mesh;
        std::vector<Places> poses(static_cast<size_t>(1 + round % 9));
        const auto part = [&] { return random.chance(0.5) ? 0 : 1.5f * kClose * static_cast<float>(random.unit()); };
        for (uint32_t i = 0; i < 60; ++i) {
            mesh.indices.push_back(mesh.add({}));
            poses[0].push_back({});
            for (size_t pose = 1; pose < poses.size(); ++pose) poses[pose].push_back({part(), part(), part()});
        }
        const WeldedMesh welded(mesh.character, mesh.indices, poses);
        Indices firsts;
        for (uint32_t vertex = 0; vertex < 60; ++vertex) {
            const auto stays_together = [&](uint32_t first) {
                return std::ranges::all_of(poses, [&](const Places& places) {
                    const Vec3<float> apart = places[vertex] - places[first];
                    return dot(apart, apart) <= kClose * kClose;
                });
            };
            const auto found = std::ranges::find_if(firsts, stays_together);
            const bool is_first = found == firsts.end();
            if (is_first) firsts.push_back(vertex);
            ++(is_first ? parted_count : joined_count);
            EXPECT_EQ(welded.point_of(vertex), welded.point_of(is_first ? vertex : *found));
            EXPECT_EQ(welded.point_of(vertex),
                      is_first ? firsts.size() - 1 : static_cast<size_t>(found - firsts.begin()));
        }
        EXPECT_EQ(welded.point_count(), firsts.size());
    }
    EXPECT_GT(joined_count, 500u);
    EXPECT_GT(parted_count, 500u);
}

// Charts meet at a point if their texture coordinates are equal there, even with other vertices in between.
TEST(WeldedMesh, ChartsMeetWhereTexturesAgree) {
    Mesh mesh;
    const std::array<std::array<float, 2>, 3> at_corner{{{0.0f, 0.5f}, {0.25f, 0.5f}, {-0.0f, 0.5f}}};
    for (uint32_t i = 0; i < 3; ++i) {
        const float turn = static_cast<float>(i), u = 10 * turn;
        mesh.indices.push_back(mesh.add({0, 0, 0}, at_corner[i]));
        mesh.indices.push_back(mesh.add({std::cos(turn), std::sin(turn), 0}, {u + 1, 0}));
        mesh.indices.push_back(mesh.add({std::cos(turn + 0.5f), std::sin(turn + 0.5f), 0}, {u + 2, 0}));
    }
    const WeldedMesh welded(mesh.character, mesh.indices, std::array{mesh.rest});
    EXPECT_EQ(welded.point_count(), 7u);
    EXPECT_TRUE(welded.most_like(1, welded.point_of(7)).is_of_same_chart);
    EXPECT_FALSE(welded.most_like(1, welded.point_of(4)).is_of_same_chart);

    // A triangle of another section with the same texture coordinates does not connect charts.
    mesh.character.sections.push_back({});
    for (const uint32_t vertex : {1u, 4u, 7u}) {
        const std::array<float, 2> texcoord = mesh.character.vertices[vertex].texcoord;
        mesh.indices.push_back(mesh.add(mesh.rest[vertex], texcoord));
    }
    const WeldedMesh both(mesh.character, mesh.indices, std::array{mesh.rest});
    EXPECT_EQ(both.point_count(), 7u);
    EXPECT_FALSE(both.most_like(1, both.point_of(4)).is_of_same_chart);
}

TEST(WeldedMesh, CanBeCancelled) {
    Mesh mesh;
    add_grid(mesh, {}, 0);
    LoadHooks hooks;
    hooks.is_cancelled = [] { return true; };
    try {
        (void)WeldedMesh(mesh.character, mesh.indices, std::array{mesh.rest}, Progress(hooks));
        ADD_FAILURE() << "went on";
    } catch (const Failure& failure) {
        EXPECT_EQ(failure.error.code, ErrorCode::kCancelled);
    }
}

TEST(WeldedMesh, FindsNoVertexOfAnotherSection) {
    Mesh mesh;
    for (const Vec3<float>& place : {Vec3<float>{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}) mesh.add(place);
    mesh.character.sections.push_back({.first_vertex = 3});
    for (const Vec3<float>& place : {Vec3<float>{1, 0, 0}, {0, 1, 0}, {1, 1, 0}}) mesh.add(place);
    mesh.indices = {0, 1, 2, 4, 3, 5};
    const WeldedMesh welded(mesh.character, mesh.indices, std::array{mesh.rest});
    EXPECT_EQ(welded.point_count(), 4u);
    EXPECT_EQ(welded.most_like(0, welded.point_of(3)).vertex, 1u);
    EXPECT_TRUE(welded.most_like(0, welded.point_of(3)).is_of_same_chart);
    EXPECT_EQ(welded.most_like(0, welded.point_of(5)).vertex, kNone);
}

TEST(Decimate, FlatMeshesLoseAlmostAllTriangles) {
    Mesh mesh;
    add_grid(mesh, {}, 0);
    const Indices few = mesh.decimated(2);
    EXPECT_EQ(few.size(), 6u);
    EXPECT_LT(furthest(mesh.indices, few, mesh.rest), 1e-6f);
}

TEST(Decimate, TrianglesThatBendInAPoseAreKept) {
    Mesh mesh;
    add_grid(mesh, {}, 0);
    Places bent = mesh.rest;
    for (Vec3<float>& place : bent) place = {std::sin(2 * place.x), place.y, std::cos(2 * place.x)};
    const Indices seen = mesh.decimated(24, {bent}), unseen = mesh.decimated(24);
    EXPECT_LE(seen.size(), 24u * 3);
    EXPECT_LT(furthest(mesh.indices, seen, bent), 0.03f);
    EXPECT_GT(furthest(mesh.indices, unseen, bent), 0.06f) << "or the pose would make no difference";
}

// One vertex moves in one of the poses. Poses after the third are in a second group of lanes.
TEST(Decimate, AllPosesCount) {
    Mesh mesh;
    add_grid(mesh, {}, 0);
    for (size_t which = 0; which < 7; ++which) {
        std::vector<Places> poses(7, mesh.rest);
        poses[which][kSide / 2 * (kSide + 1) + kSide / 2].z = 0.3f;
        EXPECT_LT(furthest(mesh.indices, mesh.decimated(10, poses), poses[which]), 0.1f) << "pose " << which + 1;
    }
}

// A comb: the gaps between its teeth must not be filled, though every removed vertex would still be on the remaining
// surface.
TEST(Decimate, GapsStayOpen) {
    Mesh mesh;
    for (uint32_t x = 0; x <= 20; ++x)
        for (uint32_t y = 0; y <= 4; ++y) mesh.add({static_cast<float>(x) / 20, static_cast<float>(y) / 20, 0});
    for (uint32_t x = 0; x < 20; ++x)
        for (uint32_t y = 0; y < 4; ++y)
            if (y == 0 || x % 4 == 0)
                for (const uint32_t step : {0u, 5u, 1u, 1u, 5u, 6u}) mesh.indices.push_back(5 * x + y + step);
    const Indices few = mesh.decimated(mesh.indices.size() / 3 / 3);
    EXPECT_LT(few.size(), mesh.indices.size() / 2);
    const TriangleIndex fine(mesh.indices, mesh.rest);
    for (size_t k = 0; k < few.size(); k += 3) {
        const Vec3<float> middle = (mesh.rest[few[k]] + mesh.rest[few[k + 1]] + mesh.rest[few[k + 2]]) * (1 / 3.0f);
        EXPECT_LT(std::sqrt(fine.nearest(middle, 0, 0).squared_distance), 0.03f);
    }
}

TEST(Decimate, ClosedMeshesStayClosed) {
    Mesh mesh;
    constexpr uint32_t kAround = 24, kDown = 12;
    for (uint32_t row = 0; row <= kDown; ++row)
        for (uint32_t column = 0; column < (row % kDown == 0 ? 1 : kAround); ++column) {
            const double turn = 6.2831853 * column / kAround, down = 3.14159265 * row / kDown;
            mesh.add(Vec3<double>{std::sin(down) * std::cos(turn), std::cos(down), std::sin(down) * std::sin(turn)}
                         .as<float>());
        }
    const auto at = [](uint32_t row, uint32_t column) {
        return row == 0 ? 0 : 1 + (row - 1) * kAround + (row == kDown ? 0 : column % kAround);
    };
    for (uint32_t row = 0; row < kDown; ++row)
        for (uint32_t column = 0; column < kAround; ++column) {
            if (row > 0)
                mesh.indices.insert(mesh.indices.end(), {at(row, column), at(row, column + 1), at(row + 1, column)});
            if (row + 1 < kDown)
                mesh.indices.insert(mesh.indices.end(),
                                    {at(row, column + 1), at(row + 1, column + 1), at(row + 1, column)});
        }
    for (const size_t triangles : {200u, 50u, 4u}) {
        const Indices few = mesh.decimated(triangles);
        EXPECT_LE(few.size(), triangles * 3);
        for (const auto& [edge, count] : edges_of(few)) EXPECT_EQ(count, 2);
    }
}

// Two charts of a texture that meet, each with its own vertices at the seam.
TEST(Decimate, TexturesKeepTheirCharts) {
    Mesh mesh;
    add_grid(mesh, {0, 0, 0}, 0.0f);
    add_grid(mesh, {1, 0, 0}, 0.8f);
    Places wavy = mesh.rest;
    for (Vec3<float>& place : wavy) place.z = 0.1f * std::sin(9 * place.x) * std::sin(7 * place.y);
    for (const size_t triangles : {300u, 100u, 30u}) {
        const Indices few = mesh.decimated(triangles, {wavy});
        ASSERT_LE(few.size(), triangles * 3);
        for (size_t k = 0; k < few.size(); ++k) {
            const Vertex& vertex = mesh.character.vertices[few[k]];
            const Vertex& beside = mesh.character.vertices[few[k - k % 3]];
            EXPECT_EQ(vertex.texcoord[0] > 0.5f, beside.texcoord[0] > 0.5f);
        }
        // They still meet without a gap
        std::array<std::set<float>, 2> heights;
        for (const uint32_t index : few)
            if (mesh.rest[index].x == 1) heights[index >= (kSide + 1) * (kSide + 1)].insert(mesh.rest[index].y);
        EXPECT_EQ(heights[0], heights[1]);
        EXPECT_GE(heights[0].size(), 2u);
    }
}

TEST(Decimate, SectionsKeepTheirVerticesAndMeet) {
    Mesh mesh;
    add_grid(mesh, {0, 0, 0}, 0);
    constexpr uint32_t kVertices = (kSide + 1) * (kSide + 1);
    mesh.character.sections.push_back({.first_vertex = kVertices});
    add_grid(mesh, {1, 0, 0}, 0);
    Places wavy = mesh.rest;
    for (Vec3<float>& place : wavy) place.z = 0.1f * std::sin(9 * place.x) * std::sin(7 * place.y);
    const Indices few = mesh.decimated(60, {wavy});
    EXPECT_LE(few.size(), 60u * 3);
    for (const Indices& all : {few, mesh.decimated(1)})
        for (size_t k = 0; k < all.size(); ++k)
            EXPECT_EQ(all[k] < kVertices, all[k - k % 3] < kVertices) << "a triangle is of one section";
    std::array<std::set<float>, 2> heights;
    for (size_t k = 0; k < few.size(); ++k) {
        if (mesh.rest[few[k]].x == 1) heights[few[k] >= kVertices].insert(mesh.rest[few[k]].y);
    }
    EXPECT_EQ(heights[0], heights[1]);
    EXPECT_GE(heights[0].size(), 2u);
}

TEST(Decimate, NoPieceVanishes) {
    Mesh mesh;
    constexpr uint32_t kPieces = 50;
    for (uint32_t i = 0; i < kPieces; ++i) {
        const Vec3<float> from{static_cast<float>(i), 0, 0};
        const uint32_t at = mesh.add(from);
        for (const Vec3<float>& way : {Vec3<float>{0.1f, 0, 0}, {0, 0.1f, 0}, {0, 0, 0.1f}}) mesh.add(from + way);
        for (const uint32_t step : {0u, 1u, 2u, 0u, 2u, 3u, 0u, 3u, 1u, 1u, 3u, 2u}) mesh.indices.push_back(at + step);
    }
    EXPECT_EQ(mesh.decimated(10).size(), mesh.indices.size());
}

// The tip of a flag has only one triangle, and must not vanish with it.
TEST(Decimate, NoPointVanishesWithItsLastTriangle) {
    Mesh mesh;
    for (const Vec3<float>& place : {Vec3<float>{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {3, 0.5f, 0}})
        mesh.add(place);
    mesh.indices = {0, 1, 2, 2, 1, 3, 3, 1, 4};
    EXPECT_LT(furthest({4}, mesh.decimated(1), mesh.rest), 1e-6f);
}

// Two parts of the mesh touch at vertex 1. When vertex 0 collapses into 2, it loses the triangle that connected it to
// the other part, and may no longer collapse into that part.
TEST(Decimate, CollapsesBesideABorderAreReplanned) {
    Mesh mesh;
    for (const Vec3<float>& place :
         {Vec3<float>{0, 0, 0}, {1, 0, 0}, {0.2f, 0.02f, 0}, {-1, 0.5f, 0}, {-1, -0.5f, 0}, {2, -1, 0}, {2, 1, 0}})
        mesh.add(place);
    mesh.indices = {0, 1, 2, 0, 2, 3, 0, 3, 4, 1, 5, 6};
    EXPECT_EQ(mesh.decimated(1), (Indices{2, 3, 4, 1, 5, 6}));
}

TEST(Decimate, RaggedMeshesStayValid) {
    Random random(4);
    float worst = 0;
    for (int round = 0; round < 40; ++round) {
        Mesh mesh;
        add_grid(mesh, {}, 0);
        for (Vec3<float>& place : mesh.rest) place.z = 0.01f * static_cast<float>(random.unit());
        Indices ragged;
        for (size_t k = 0; k < mesh.indices.size(); k += 3)
            if (random.chance(0.6)) ragged.insert(ragged.end(), &mesh.indices[k], &mesh.indices[k] + 3);
        mesh.indices = ragged;
        const std::set<uint32_t> before(ragged.begin(), ragged.end());
        const Indices few = mesh.decimated(40);
        std::set<std::set<uint32_t>> triangles;
        for (size_t k = 0; k < few.size(); k += 3) {
            const std::set<uint32_t> corners{few[k], few[k + 1], few[k + 2]};
            EXPECT_EQ(corners.size(), 3u);
            EXPECT_TRUE(triangles.insert(corners).second) << "twice the same";
            for (const uint32_t corner : corners) EXPECT_TRUE(before.contains(corner));
            EXPECT_GT(cross(mesh.rest[few[k + 1]] - mesh.rest[few[k]], mesh.rest[few[k + 2]] - mesh.rest[few[k]]).z, 0);
        }
        worst = std::max(worst, furthest(ragged, few, mesh.rest));
    }
    EXPECT_LT(worst, 0.13f);
}

// The work must not grow with the square of the number of triangles around a point.
TEST(Decimate, ManyTrianglesAroundOnePointAreFast) {
    Mesh mesh;
    constexpr uint32_t kAround = 30'000;
    const uint32_t middle = mesh.add({});
    for (uint32_t i = 0; i < kAround; ++i) {
        const double turn = 6.283185307 * i / kAround;
        mesh.add(Vec3<double>{std::cos(turn), std::sin(turn), 0}.as<float>());
        mesh.indices.insert(mesh.indices.end(), {middle, 1 + i, 1 + (i + 1) % kAround});
    }
    const Indices few = mesh.decimated(kAround / 10);
    EXPECT_LE(few.size(), kAround / 10 * 3);
    EXPECT_LT(furthest(mesh.indices, few, mesh.rest), 1e-4f);
}

TEST(Decimate, ExtremeOrEqualPositionsAreHandled) {
    for (const float scale : {0.0f, 1e-30f, 1e25f}) {
        Mesh mesh;
        add_grid(mesh, {}, 0);
        for (Vec3<float>& place : mesh.rest) place = place * scale;
        const Indices few = mesh.decimated(20);
        EXPECT_LE(few.size(), mesh.indices.size());
        for (const uint32_t index : few) EXPECT_LT(index, mesh.rest.size());
    }
}

TEST(Decimate, IsDeterministic) {
    Mesh mesh;
    add_grid(mesh, {}, 0);
    EXPECT_EQ(mesh.decimated(40), mesh.decimated(40));
}

}  // namespace
}  // namespace throng::test
