// Which triangle of a mesh is nearest to a point.
#pragma once

#include "compile/mesh/four_triangles.h"

#include <throng/transform.h>

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace throng {

using Triangle = std::array<Vec3<float>, 3>;

// The squared distance of a point from a triangle, which may be degenerate: a line or a point. Despite rounding it is
// never below the squared distance from the triangle's box, so a search by boxes cannot miss the nearest triangle.
float squared_distance(const Vec3<float>& p, const Triangle& triangle);
// The same for four points and four triangles.
Four squared_distances(const Four3& p, const Four3& a, const Four3& b, const Four3& c);

// A balanced tree of bounding boxes over a mesh, with up to four children per node. If the mesh moves, the boxes are
// refitted and the tree keeps its shape.
class TriangleIndex {
public:
    struct Nearest {
        float squared_distance = std::numeric_limits<float>::infinity();  // stays infinite if there are no triangles
        uint32_t triangle = 0;                                            // an index into corners()
        uint32_t steps = 0;                                               // each tests four boxes or triangles
    };

    TriangleIndex() = default;
    // Every three `indices` form a triangle.
    TriangleIndex(std::span<const uint32_t> indices, std::span<const Vec3<float>> positions);

    // Moves the vertices and refits the boxes. The triangles stay the same.
    void move(std::span<const Vec3<float>> positions);

    // [triangle]: its vertices. Triangles that share a box are adjacent.
    std::span<const std::array<uint32_t, 3>> corners() const { return corners_; }

    // Returns the nearest triangle, or any that is no farther than `enough` (a squared distance). The search begins
    // around `guess`. Any triangle will do, but it is fast if this one was near the point, or near a neighbouring
    // point, before.
    Nearest nearest(const Vec3<float>& p, float enough, uint32_t guess) const;

private:
    // A part of the tree: an index into nodes_, or into leaves_ if kLeaf is set.
    using Part = uint32_t;
    static constexpr Part kLeaf = uint32_t{1} << 31;

    struct Box {
        Vec3<float> low, high;
    };
    struct Node {
        Four3 low{}, high{};  // the boxes of four parts; only the first part_count exist
        std::array<Part, kLanes> parts{};
        uint32_t part_count = 0;
        uint32_t parent = 0, lane = 0;  // the node and the lane that hold its own box
    };
    struct Leaf {
        Four3 a{}, b{}, c{};  // the corners of four triangles; if there are fewer, the last one is repeated
        uint32_t first_triangle = 0, triangle_count = 0;
        uint32_t parent = 0;
    };
    struct Centroid {
        Vec3<float> place;  // the sum of the corners: three times the centroid
        uint32_t triangle = 0;
    };

    static void halve(std::span<Centroid> centroids);
    Part add_part(std::span<Centroid> centroids, uint32_t first, uint32_t parent, uint32_t lane);
    Box box_of(Part part) const;
    void look_at(const Leaf& leaf, const Four3& p, Nearest& best) const;
    void search_below(uint32_t node, Part except, const Four3& p, float enough, Nearest& best) const;

    std::vector<Node> nodes_;  // parents before children
    std::vector<Leaf> leaves_;
    std::vector<std::array<uint32_t, 3>> corners_;
    std::vector<uint32_t> leaf_of_;  // [triangle]
};

}  // namespace throng
