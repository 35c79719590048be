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

// The squared distance of a point from a triangle, which can be as thin as a line or a point. Never below the squared
// distance from the triangle's box, whatever rounding does, so that no search by boxes misses the nearest triangle.
float squared_distance(const Vec3<float>& p, const Triangle& triangle);

// A balanced tree of boxes over a mesh, four below each. The mesh may move: the tree keeps its shape, and its boxes
// follow.
class TriangleIndex {
public:
    struct Nearest {
        float squared_distance = std::numeric_limits<float>::infinity();  // if the index has no triangles
        uint32_t triangle = 0;                                            // an index into corners()
        uint32_t steps = 0;                                               // each looks at four boxes or triangles
    };

    TriangleIndex() = default;
    // Every three `indices` form a triangle.
    TriangleIndex(std::span<const uint32_t> indices, std::span<const Vec3<float>> positions);

    // The same triangles, with their vertices elsewhere.
    void move(std::span<const Vec3<float>> positions);

    // [triangle], vertices. Triangles that share a box are side by side.
    std::span<const std::array<uint32_t, 3>> corners() const { return corners_; }

    // The nearest triangle; or, if any are no farther than `enough` (a squared distance), one of those. The search
    // begins around `guess`: ideally a triangle that was near to this point before, or near to a point beside it, but
    // any will do.
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
        uint32_t parent = 0, lane = 0;  // where its own box is
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

    std::vector<Node> nodes_;  // each before those below it
    std::vector<Leaf> leaves_;
    std::vector<std::array<uint32_t, 3>> corners_;
    std::vector<uint32_t> leaf_of_;  // [triangle]
};

}  // namespace throng
