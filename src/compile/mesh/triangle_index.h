// Which triangle of a mesh is nearest to a point.
#pragma once

#include <throng/transform.h>

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace throng {

using Triangle = std::array<Vec3<float>, 3>;

// Squared, of a point from a triangle, which may be as thin as a line or a point. Not below the squared distance from
// the triangle's box, whatever rounding does, so that no search by boxes misses the triangle of the smallest.
float squared_distance(const Vec3<float>& p, const Triangle& triangle);

// A balanced tree of boxes over a mesh. The mesh may move: the tree keeps its shape, and its boxes follow.
class TriangleIndex {
public:
    struct Nearest {
        float squared_distance = std::numeric_limits<float>::infinity();  // of the index without triangles
        uint32_t triangle = 0;                                            // of triangles()
        uint32_t steps = 0;                                               // boxes and triangles looked at
    };

    TriangleIndex() = default;
    // Three of `indices` are a triangle.
    TriangleIndex(std::span<const uint32_t> indices, std::span<const Vec3<float>> positions);

    // The same triangles, their vertices elsewhere.
    void move(std::span<const Vec3<float>> positions);

    // Those that share a box side by side.
    std::span<const Triangle> triangles() const { return triangles_; }
    std::span<const std::array<uint32_t, 3>> corners() const { return corners_; }  // [triangle], vertices

    // The smallest squared distance of all triangles; or, where one is no farther than `enough`, that of any such.
    // The search begins around `guess`: a triangle that was near to this point before, or to one beside it, or any.
    Nearest nearest(const Vec3<float>& p, float enough, uint32_t guess) const;

private:
    struct Node {
        Vec3<float> low, high;
        uint32_t first = 0;  // of a leaf's triangles; else the second child: the first comes right behind its parent
        uint32_t count = 0;  // of a leaf's triangles; else 0
        uint32_t parent = 0;
    };
    struct Centroid {
        Vec3<float> place;  // three times as far from the origin
        uint32_t triangle = 0;
    };

    void split(std::span<Centroid> centroids, uint32_t first, uint32_t parent);
    void look_at(const Vec3<float>& p, uint32_t triangle, Nearest& best) const;
    void search_below(uint32_t node, const Vec3<float>& p, float enough, Nearest& best) const;

    std::vector<Node> nodes_;  // each before those below it
    std::vector<Triangle> triangles_;
    std::vector<std::array<uint32_t, 3>> corners_;
    std::vector<uint32_t> leaves_;  // [triangle], nodes
};

}  // namespace throng
