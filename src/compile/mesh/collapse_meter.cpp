#include "compile/mesh/collapse_meter.h"

#include <algorithm>

namespace throng {
namespace {

// A collapse also costs this fraction of its edge's length, so that on a flat surface the shortest edge goes first.
constexpr float kLengthWeight = 1e-2f;
// The search for the nearest fine triangle ends at one that is within this fraction of the cost known so far.
constexpr float kNearEnough = 0.5f;
// A point with more triangles around it is not collapsed, nor is another point collapsed into it: the work for that
// grows with the square of their number.
constexpr size_t kMaxFaces = 48;
constexpr float kTurned = 0.3f;  // the cosine of the angle by which a triangle may turn in the rest pose

}  // namespace

CollapseMeter::CollapseMeter(const WeldedMesh& fine, const TriangleIndex& fine_surface, const SimplifiedMesh& mesh)
    : fine_(fine),
      fine_surface_(fine_surface),
      mesh_(mesh),
      near_triangle_(fine.point_count()),
      marks_(fine.point_count()) {
    for (uint32_t triangle = 0; triangle < fine_surface.corners().size(); ++triangle)
        for (const uint32_t vertex : fine_surface.corners()[triangle])
            near_triangle_[fine_.point_of(vertex)] = triangle;
}

std::vector<Collapse> CollapseMeter::possible_collapses(uint32_t from) {
    std::vector<Collapse> all;
    if (mesh_.faces_of(from).size() > kMaxFaces) return all;
    look_around(from);
    float least = kNever;
    for (const uint32_t to : mesh_.neighbours_of(from)) {
        Collapse one{.to = to, .extra = kLengthWeight * length(fine_.rest_place(from) - fine_.rest_place(to))};
        if (mesh_.faces_of(to).size() > kMaxFaces || !try_moving(one)) continue;
        const float useful = one.squared_distance_at(least);
        one.squared_distance = distance_of_lost(0, 0, useful);
        one.groups = one.squared_distance <= useful ? 1 : 0;
        const float cost = one.cost();
        if (cost >= kNever) continue;
        all.push_back(one);
        least = std::min(least, cost);
    }
    std::ranges::sort(all, {}, &Collapse::cost);
    return all;
}

Collapse CollapseMeter::cheapest(uint32_t from, std::span<const Collapse> possible) {
    look_around(from);
    Collapse best{.squared_distance = kNever};
    for (Collapse one : possible) {
        if (one.cost() >= best.cost()) break;
        measure(one, best.cost());
        if (one.cost() < best.cost()) best = one;
    }
    return best;
}

void CollapseMeter::look_around(uint32_t from) {
    around_.clear();
    lost_.assign(1, from);
    for (const uint32_t number : mesh_.faces_of(from)) {
        const SimplifiedMesh::Face& face = mesh_.face(number);
        const size_t corner = face.points[0] == from ? 0 : face.points[1] == from ? 1 : 2;
        const Vec3<float> normal = rest_normal(face.points);
        around_.push_back({face.points, corner, face.vertices[corner], normal, length(normal)});
        lost_.insert(lost_.end(), face.lost.begin(), face.lost.end());
    }
}

// Fills moved_ with the triangles that move. Returns false if one of them would turn over, leave its section or
// duplicate another triangle, or if another point would lose its last triangle.
bool CollapseMeter::try_moving(Collapse& collapse) {
    moved_.clear();
    const uint32_t to = collapse.to;
    mark_neighbours_of(to);
    for (const Around& one : around_) {
        const uint32_t left = one.points[(one.corner + 1) % 3], right = one.points[(one.corner + 2) % 3];
        if (left == to || right == to) {
            if (mesh_.faces_of(left == to ? right : left).size() == 1) return false;
            continue;
        }
        if (target_has_face(to, left, right)) return false;
        Corners moved = one.points;
        moved[one.corner] = to;
        const Vec3<float> normal = rest_normal(moved);
        if (dot(one.rest_normal, normal) <= kTurned * one.length * length(normal)) return false;
        const WeldedMesh::Corner vertex = fine_.most_like(one.vertex, to);
        if (vertex.vertex == kNone) return false;
        if (!vertex.is_of_same_chart) collapse.extra = std::max(collapse.extra, height_of(moved));
        moved_.push_back(moved);
    }
    return !moved_.empty();
}

void CollapseMeter::mark_neighbours_of(uint32_t point) {
    ++mark_;
    for (const uint32_t number : mesh_.faces_of(point))
        for (const uint32_t other : mesh_.face(number).points) marks_[other] = mark_;
}

// The marks answer nearly always: two points have few common neighbours apart from the triangles that vanish.
bool CollapseMeter::target_has_face(uint32_t target, uint32_t left, uint32_t right) const {
    if (marks_[left] != mark_ || marks_[right] != mark_) return false;
    return std::ranges::any_of(mesh_.faces_of(target), [&](uint32_t number) {
        return mesh_.face(number).has(left) && mesh_.face(number).has(right);
    });
}

Vec3<float> CollapseMeter::rest_normal(const Corners& corners) const {
    const Vec3<float> a = fine_.rest_place(corners[0]);
    return cross(fine_.rest_place(corners[1]) - a, fine_.rest_place(corners[2]) - a);
}

// The least of a triangle's three heights. If a corner takes its texture coordinates from another chart, the whole
// triangle shows a wrong part of the texture. That looks about as bad as a surface displaced by this height.
float CollapseMeter::height_of(const Corners& corners) const {
    float longest = 0;
    for (size_t k = 0; k < 3; ++k)
        longest = std::max(longest, length(fine_.rest_place(corners[(k + 1) % 3]) - fine_.rest_place(corners[k])));
    return longest > 0 ? length(rest_normal(corners)) / longest : 0;
}

// Measures the squared distance, but stops once the collapse cannot cost less than `least`.
void CollapseMeter::measure(Collapse& collapse, float least) {
    try_moving(collapse);
    const float useful = collapse.squared_distance_at(least);
    for (size_t group = collapse.groups; group < fine_.groups() && collapse.squared_distance < useful; ++group)
        collapse.squared_distance = distance_of_lost(group, collapse.squared_distance, useful);
    if (collapse.squared_distance < useful) measure_middles(collapse, useful);
}

// The largest squared distance of the points lost_ from the triangles moved_ in a group of poses, or `known` if that is
// larger. May stop early with any value above `useful`.
float CollapseMeter::distance_of_lost(size_t group, float known, float useful) {
    triangles_.clear();
    for (const auto& [a, b, c] : moved_)
        triangles_.emplace_back(fine_.places(a)[group], fine_.places(b)[group], fine_.places(c)[group]);
    Four furthest = four(known);
    size_t likely = 0;  // the triangle tested last: it is usually near enough to the next point too
    for (const uint32_t point : lost_) {
        const Four3 place = fine_.places(point)[group];
        const size_t first = likely;
        Four nearest = triangles_[first].squared_distance(place);
        for (size_t i = 0; i < triangles_.size() && is_any(nearest > furthest); ++i) {
            if (i == first) continue;
            nearest = lower(nearest, triangles_[i].squared_distance(place));
            likely = i;
        }
        furthest = higher(furthest, nearest);
        if (largest(furthest) > useful) break;
    }
    return largest(furthest);
}

// Measures the other direction, from the coarse mesh to the fine one. All lost points may lie near a surface that spans
// a gap of the fine mesh, such as the one between two fingers. So the middles of the triangles that move, and of their
// edges, are compared with the fine mesh too.
void CollapseMeter::measure_middles(Collapse& collapse, float useful) {
    uint32_t guess = near_triangle_[collapse.to];
    ends_.clear();
    for (const Corners& corners : moved_) {
        if (collapse.squared_distance >= useful) return;
        measure_middle(corners, 1 / 3.0f, guess, collapse);
        for (const uint32_t end : corners) {
            if (end == collapse.to || std::ranges::find(ends_, end) != ends_.end()) continue;
            ends_.push_back(end);
            measure_middle({collapse.to, end, kNone}, 1 / 2.0f, guess, collapse);
        }
    }
}

// Measures the distance of a middle from one fine triangle in all poses. `guess`, which was near the previous middle,
// is enough if its distance does not raise the result. Otherwise searches for the nearest triangle in the rest pose,
// which becomes the guess.
void CollapseMeter::measure_middle(const Corners& ends, float part, uint32_t& guess, Collapse& collapse) {
    const auto middle_in = [&](size_t group) {
        Four3 sum = fine_.places(ends[0])[group] + fine_.places(ends[1])[group];
        if (ends[2] != kNone) sum = sum + fine_.places(ends[2])[group];
        return sum * four(part);
    };
    // Beyond `enough`, any value above it will do
    const auto furthest_from = [&](uint32_t triangle, float enough) {
        std::array<const Four3*, 3> corners;
        for (size_t k = 0; k < 3; ++k) corners[k] = fine_.places(fine_.point_of(fine_surface_.corners()[triangle][k]));
        float furthest = 0;
        for (size_t group = 0; group < fine_.groups() && furthest <= enough; ++group) {
            const FourTriangles in_poses(corners[0][group], corners[1][group], corners[2][group]);
            furthest = std::max(furthest, largest(in_poses.squared_distance(middle_in(group))));
        }
        return furthest;
    };
    if (furthest_from(guess, collapse.squared_distance) <= collapse.squared_distance) return;
    const float near_enough = kNearEnough * collapse.cost();
    guess = fine_surface_.nearest(middle_in(0).at(0), near_enough * near_enough, guess).triangle;
    collapse.squared_distance = std::max(collapse.squared_distance, furthest_from(guess, kNever));
}

}  // namespace throng
