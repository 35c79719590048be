// What it costs to collapse a point of a mesh into one of its neighbours.
#pragma once

#include "compile/mesh/four_triangles.h"
#include "compile/mesh/simplified_mesh.h"
#include "compile/mesh/triangle_index.h"
#include "compile/mesh/welded_mesh.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace throng {

constexpr float kNever = std::numeric_limits<float>::infinity();  // the cost of a collapse that must not happen

// A point that moves into one of its neighbours, and what that costs: distances in model space.
struct Collapse {
    uint32_t to = 0;
    float extra = 0;             // for the edge's length, and for triangles that get a wrong texture
    float squared_distance = 0;  // between the surfaces, as far as they have been compared
    uint32_t groups = 0;         // of poses in which all lost points have been compared

    // The squared distance at which this collapse would cost `cost`.
    float squared_distance_at(float cost) const { return cost > extra ? (cost - extra) * (cost - extra) : 0; }
    // Also infinite if the sum is NaN, as in meshes whose squared lengths overflow floats.
    float cost() const {
        const float all = std::sqrt(squared_distance) + extra;
        return all < kNever ? all : kNever;
    }
};

class CollapseMeter {
public:
    // `fine_surface` is the fine mesh at rest. Keeps the references.
    CollapseMeter(const WeldedMesh& fine, const TriangleIndex& fine_surface, const SimplifiedMesh& mesh);

    // The possible collapses, the cheapest first. Their cost counts only how far the lost points lie from the remaining
    // mesh in the first group of poses. It is exact for the first; for the others it may be a lower bound, which is no
    // less than that.
    std::vector<Collapse> possible_collapses(uint32_t from);

    // The cheapest of `possible` in all poses, with distances measured in both directions. `possible` must hold the
    // point's collapses in the current mesh. The result costs kNever if there is none.
    Collapse cheapest(uint32_t from, std::span<const Collapse> possible);

private:
    using Corners = std::array<uint32_t, 3>;  // points

    void look_around(uint32_t from);
    void mark_neighbours_of(uint32_t point);
    bool target_has_face(uint32_t target, uint32_t left, uint32_t right) const;
    bool try_moving(Collapse& collapse);
    void measure(Collapse& collapse, float least);
    float distance_of_lost(size_t group, float known, float useful);
    void measure_middles(Collapse& collapse, float useful);
    void measure_middle(const Corners& ends, float part, uint32_t& guess, Collapse& collapse);
    Vec3<float> rest_normal(const Corners& corners) const;
    float height_of(const Corners& corners) const;

    // A triangle around the point that look_around() was called for.
    struct Around {
        Corners points;
        size_t corner = 0;    // which of its corners is the point
        uint32_t vertex = 0;  // of the character, at that corner
        Vec3<float> rest_normal;
        float length = 0;  // of rest_normal
    };

    const WeldedMesh& fine_;
    const TriangleIndex& fine_surface_;
    const SimplifiedMesh& mesh_;
    std::vector<uint32_t> near_triangle_;  // [points], triangles of fine_surface_
    // Filled by look_around(), for a point
    std::vector<Around> around_;
    std::vector<uint32_t> lost_;  // the point itself, and the lost points of its triangles
    // Filled while one of its collapses is measured
    std::vector<uint32_t> marks_;           // [points]: mark_ at the target and its neighbours
    uint32_t mark_ = 0;                     // a new number for each target
    std::vector<Corners> moved_;            // triangles
    std::vector<FourTriangles> triangles_;  // moved_, in a group of poses
    std::vector<uint32_t> ends_;            // of edges that have been measured
};

}  // namespace throng
