// TriangleIndex: the nearest triangle, against an exhaustive search and a distance computed in another way.
#include "compile/mesh/triangle_index.h"
#include "tests/test_rig.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <vector>

namespace throng::test {
namespace {

using Place = Vec3<float>;

struct IndexedMesh {
    std::vector<Place> positions;
    std::vector<uint32_t> indices;

    void add(const std::vector<Place>& corners) {
        for (const Place& corner : corners) {
            indices.push_back(static_cast<uint32_t>(positions.size()));
            positions.push_back(corner);
        }
    }
    Triangle triangle(size_t number) const {
        return {positions[indices[3 * number]], positions[indices[3 * number + 1]], positions[indices[3 * number + 2]]};
    }
    size_t triangle_count() const { return indices.size() / 3; }
};

Place place_within(Random& random, double extent) { return random.vector(extent).as<float>(); }

IndexedMesh soup(Random& random, size_t count, double extent, double triangle_size) {
    IndexedMesh mesh;
    for (size_t i = 0; i < count; ++i) {
        const Place at = place_within(random, extent);
        mesh.add({at + place_within(random, triangle_size), at + place_within(random, triangle_size),
                  at + place_within(random, triangle_size)});
    }
    return mesh;
}

// Points, lines whose corners are slightly off due to rounding, and needles, each several times.
IndexedMesh degenerate_soup(Random& random) {
    IndexedMesh mesh;
    for (int i = 0; i < 60; ++i) {
        const Place a = place_within(random, 1), b = place_within(random, 1), c = place_within(random, 1);
        const Place between = lerp(a, b, static_cast<float>(random.unit()));
        for (int time = 0; time < 3; ++time) {
            mesh.add({a, a, a});
            mesh.add({a, b, a});
            mesh.add({a, b, between});
            mesh.add({between, b, a});
            mesh.add({a, b, lerp(a, c, 1e-5f)});
            mesh.add({a, b, lerp(between, c, 1e-6f)});
        }
    }
    return mesh;
}

double sheet_height(double x, double z) { return 0.1 * std::sin(9 * x) * std::cos(7 * z); }

// A bumpy and rough sheet of 2 * side * side triangles, a unit long.
IndexedMesh sheet(Random& random, uint32_t side) {
    IndexedMesh mesh;
    for (uint32_t row = 0; row <= side; ++row)
        for (uint32_t column = 0; column <= side; ++column) {
            const double x = 1.0 * column / side, z = 1.0 * row / side;
            mesh.positions.push_back(Vec3<double>{x, sheet_height(x, z) + 0.1 / side * random.unit(), z}.as<float>());
        }
    for (uint32_t row = 0; row < side; ++row)
        for (uint32_t column = 0; column < side; ++column) {
            const uint32_t at = row * (side + 1) + column, below = at + side + 1;
            mesh.indices.insert(mesh.indices.end(), {at, below, at + 1, at + 1, below, below + 1});
        }
    return mesh;
}

float smallest_of_all(const IndexedMesh& mesh, const Place& p) {
    float smallest = std::numeric_limits<float>::infinity();
    for (size_t t = 0; t < mesh.triangle_count(); ++t)
        smallest = std::min(smallest, squared_distance(p, mesh.triangle(t)));
    return smallest;
}

// Expects the exact bits wherever the search begins. With a distance that is enough, the search may end early.
void expect_nearest(const TriangleIndex& index, const IndexedMesh& mesh, const std::vector<Place>& places,
                    Random& random) {
    for (const Place& p : places) {
        const float wanted = smallest_of_all(mesh, p);
        for (int i = 0; i < 3; ++i) {
            const TriangleIndex::Nearest found = index.nearest(
                p, 0, random.below(static_cast<uint32_t>(mesh.triangle_count())));
            ASSERT_EQ(found.squared_distance, wanted);
            const auto& [a, b, c] = index.corners()[found.triangle];
            const Triangle triangle{mesh.positions[a], mesh.positions[b], mesh.positions[c]};
            ASSERT_EQ(squared_distance(p, triangle), wanted);
        }
        for (const float part : {0.5f, 0.999f, 1.0f, 1.5f, 100.0f}) {
            const float enough = part * wanted;
            const TriangleIndex::Nearest found = index.nearest(p, enough, 0);
            ASSERT_GE(found.squared_distance, wanted);
            if (found.squared_distance > enough) {
                ASSERT_EQ(found.squared_distance, wanted);
            }
        }
    }
}

std::vector<Place> places_around(Random& random, const IndexedMesh& mesh) {
    std::vector<Place> places;
    for (int i = 0; i < 60; ++i) {
        places.push_back(place_within(random, 1.5));
        places.push_back(place_within(random, 1e5));
        const Place corner = mesh.positions[random.below(static_cast<uint32_t>(mesh.positions.size()))];
        places.push_back(corner);
        places.push_back(corner + place_within(random, 1e-4));
    }
    return places;
}

TEST(TriangleIndex, FindsTheNearestOfAllTriangles) {
    Random random(3);
    std::vector<IndexedMesh> meshes{soup(random, 1, 1, 1),      soup(random, 2, 1, 1),   soup(random, 5, 1, 1),
                                    soup(random, 700, 1, 0.05), soup(random, 300, 1, 2), degenerate_soup(random),
                                    sheet(random, 20)};
    IndexedMesh one_many_times;
    for (int i = 0; i < 100; ++i) one_many_times.add({{0, 0, 0}, {1, 0, 0}, {0, 1, 0.5f}});
    meshes.push_back(one_many_times);
    for (IndexedMesh& mesh : meshes) {
        TriangleIndex index(mesh.indices, mesh.positions);
        ASSERT_EQ(index.corners().size(), mesh.triangle_count());
        expect_nearest(index, mesh, places_around(random, mesh), random);
        for (Place& position : mesh.positions) position = position * 0.5f + place_within(random, 0.3);
        index.move(mesh.positions);
        expect_nearest(index, mesh, places_around(random, mesh), random);
    }
}

TEST(TriangleIndex, WithoutTrianglesNothingIsNear) {
    EXPECT_EQ(TriangleIndex().nearest({0, 0, 0}, 0, 0).squared_distance, std::numeric_limits<float>::infinity());
    EXPECT_EQ(TriangleIndex({}, {}).nearest({0, 0, 0}, 0, 0).squared_distance, std::numeric_limits<float>::infinity());
}

// Non-finite positions also end the search.
TEST(TriangleIndex, NonFinitePositionsEndTheSearch) {
    Random random(4);
    const IndexedMesh mesh = soup(random, 100, 1, 0.1);
    const TriangleIndex index(mesh.indices, mesh.positions);
    for (const float wrong : {std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN(), 3e38f})
        EXPECT_EQ(index.nearest({wrong, 0, 0}, 0, 7).squared_distance, std::numeric_limits<float>::infinity());
}

double distance_to_segment(const Vec3<double>& p, const Vec3<double>& a, const Vec3<double>& b) {
    const Vec3<double> edge = b - a;
    const double squared = dot(edge, edge);
    return length(p - (a + edge * (squared > 0 ? std::clamp(dot(p - a, edge) / squared, 0.0, 1.0) : 0.0)));
}

// By the barycentric weights of the nearest point in the plane (C. Ericson, Real-Time Collision Detection, 2005, 3.4).
double distance_to_triangle(const Vec3<double>& p, const Vec3<double>& a, const Vec3<double>& b,
                            const Vec3<double>& c) {
    double nearest = std::min(
        {distance_to_segment(p, a, b), distance_to_segment(p, b, c), distance_to_segment(p, c, a)});
    const Vec3<double> ab = b - a, ac = c - a, ap = p - a;
    const double bb = dot(ab, ab), bc = dot(ab, ac), cc = dot(ac, ac), whole = bb * cc - bc * bc;
    if (!(whole > 1e-14 * bb * cc)) return nearest;
    const double v = (cc * dot(ap, ab) - bc * dot(ap, ac)) / whole, w = (bb * dot(ap, ac) - bc * dot(ap, ab)) / whole;
    if (v >= 0 && w >= 0 && v + w <= 1) nearest = std::min(nearest, length(p - (a + ab * v + ac * w)));
    return nearest;
}

TEST(TriangleIndex, DistancesAreRightOfThinTrianglesToo) {
    Random random(5);
    for (const IndexedMesh& mesh : {soup(random, 2000, 1, 0.3), degenerate_soup(random), sheet(random, 8)}) {
        double worst = 0;
        for (size_t t = 0; t < mesh.triangle_count(); ++t) {
            const Triangle triangle = mesh.triangle(t);
            const auto& [a, b, c] = triangle;
            const Vec3<double> ab = b.as<double>() - a.as<double>(), ac = c.as<double>() - a.as<double>();
            const Vec3<double> up = normalized(cross(ab, ac));
            for (int i = 0; i < 200; ++i) {
                // Either anywhere, or above the triangle's interior, where a wrong normal would show.
                const double v = random.unit(), w = random.between(0, 1 - v);
                const Vec3<double> above = a.as<double>() + ab * v + ac * w + up * random.between(-1, 1);
                const Place p = i % 2 == 0 ? place_within(random, 1.5) : above.as<float>();
                const double wanted = distance_to_triangle(p.as<double>(), a.as<double>(), b.as<double>(),
                                                           c.as<double>());
                worst = worse_of(worst, std::abs(std::sqrt(double{squared_distance(p, triangle)}) - wanted));
            }
        }
        EXPECT_LE(worst, 2e-5);
    }
}

// The number of boxes and triangles visited grows with the number of levels, not triangles: for adjacent places and
// random ones, each about as far from the mesh as its triangles are long.
TEST(TriangleIndex, VisitsFewTriangles) {
    Random random(6);
    std::vector<double> beside, at_random;
    for (const uint32_t side : {20u, 200u}) {
        const IndexedMesh mesh = sheet(random, side);
        const TriangleIndex index(mesh.indices, mesh.positions);
        constexpr int kPlaces = 4000;
        uint64_t steps_beside = 0, steps_at_random = 0;
        uint32_t guess = 0;
        const auto above = [side](double x, double z) {
            return Vec3<double>{x, sheet_height(x, z) + 1.0 / side, z}.as<float>();
        };
        for (int i = 0; i < kPlaces; ++i) {
            const double along = 1.0 * i / kPlaces, x = random.unit(), z = random.unit();
            const TriangleIndex::Nearest found = index.nearest(above(along, along), 0, guess);
            guess = found.triangle;
            steps_beside += found.steps;
            const uint32_t any = random.below(static_cast<uint32_t>(mesh.triangle_count()));
            steps_at_random += index.nearest(above(x, z), 0, any).steps;
        }
        beside.push_back(static_cast<double>(steps_beside) / kPlaces);
        at_random.push_back(static_cast<double>(steps_at_random) / kPlaces);
        std::printf("  %zu triangles: %.0f steps beside the last place, %.0f at random\n", mesh.triangle_count(),
                    beside.back(), at_random.back());
    }
    EXPECT_LE(beside[1], 2 * beside[0]);
    EXPECT_LE(at_random[1], 2 * at_random[0]);
}

}  // namespace
}  // namespace throng::test
