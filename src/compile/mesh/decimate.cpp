#include "compile/mesh/decimate.h"

#include "base/count.h"
#include "compile/mesh/triangle_index.h"
#include "compile/mesh/welded_mesh.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>

namespace throng {
namespace {

constexpr float kNever = std::numeric_limits<float>::infinity();
// A collapse costs this part of its edge's length in addition, so that on a flat surface the shortest edge goes first.
constexpr float kLengthWeight = 1e-2f;
// A fine triangle within this part of the cost known so far is taken for the nearest one: the search ends there.
constexpr float kNearEnough = 0.5f;
// A point with more triangles around it is not collapsed, nor is another one into it: the work for that grows with the
// square of their number.
constexpr size_t kMostFaces = 48;
// A triangle with more lost points than this forgets every second one: the work grows with their number.
constexpr size_t kMostLost = 128;
constexpr uint64_t kStepsBetweenReports = 1000;  // some 20 ms
constexpr float kTurned = 0.3f;  // the cosine of the angle by which a triangle may turn in the rest pose

void erase_copies(std::vector<uint32_t>& numbers) {
    std::ranges::sort(numbers);
    numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
}

class Decimation {
public:
    Decimation(const Character& character, std::span<const uint32_t> indices,
               std::span<const std::vector<Vec3<float>>> positions)
        : mesh_(character, indices, positions),
          fine_(indices, positions[0]),
          faces_(mesh_.faces().begin(), mesh_.faces().end()),
          face_count_(faces_.size()),
          points_(mesh_.point_count()) {
        for (uint32_t face = 0; face < faces_.size(); ++face)
            for (const uint32_t point : faces_[face].points) points_[point].faces.push_back(face);
        for (uint32_t triangle = 0; triangle < fine_.corners().size(); ++triangle)
            for (const uint32_t vertex : fine_.corners()[triangle])
                points_[mesh_.point_of(vertex)].near_triangle = triangle;
    }

    void plan_all(const Progress& progress) {
        for (uint32_t point = 0; point < points_.size(); ++point) {
            if (point % kStepsBetweenReports == 0) progress.report(point, points_.size());
            plan(point);
        }
    }

    void collapse_to(size_t face_count, const Progress& progress) {
        for (uint64_t step = 0; face_count_ > face_count && !queue_.empty(); ++step) {
            if (step % kStepsBetweenReports == 0) progress.report(faces_.size() - face_count_, faces_.size());
            const Planned next = queue_.top();
            queue_.pop();
            const Point& point = points_[next.point];
            if (next.version != point.version) continue;
            if (point.is_outdated)
                plan(next.point);
            else if (!point.is_measured)
                confirm(next.point);
            else
                collapse(next.point, point.target);
        }
    }

    std::vector<uint32_t> indices() const {
        std::vector<uint32_t> all;
        for (const Face& face : faces_)
            if (face.is_there) all.insert(all.end(), face.vertices.begin(), face.vertices.end());
        return all;
    }

private:
    struct Face : WeldedFace {
        explicit Face(const WeldedFace& face) : WeldedFace(face) {}

        bool has(uint32_t point) const { return std::ranges::find(points, point) != points.end(); }

        void forget() {
            if (lost.size() <= kMostLost) return;
            for (size_t i = 0; 2 * i < lost.size(); ++i) lost[i] = lost[2 * i];
            lost.resize((lost.size() + 1) / 2);
        }

        bool is_there = true;
        std::vector<uint32_t> lost;  // collapsed points that it is the nearest triangle to
    };
    struct Point {
        std::vector<uint32_t> faces;
        uint32_t target = kNone;     // the neighbour that it would be collapsed into
        bool is_measured = false;    // the cost of that in the queue is exact; else a lower bound
        float others_cost = 0;       // a lower bound for all other neighbours
        uint32_t version = 0;        // of the plan: entries of the queue with another one are void
        bool is_outdated = false;    // triangles around it have changed since it was planned
        uint32_t near_triangle = 0;  // of the fine mesh
    };
    struct Planned {
        float cost = 0;
        uint32_t point = 0, version = 0;

        friend bool operator<(const Planned& a, const Planned& b) {  // the least cost on top
            return a.cost != b.cost ? a.cost > b.cost : a.point > b.point;
        }
    };
    // Of one point into another. Costs are distances in model space.
    struct Collapse {
        uint32_t to = 0;
        float extra = 0;             // for the edge's length, and for what gets a wrong texture
        float squared_distance = 0;  // between the surfaces, as far as they have been compared

        // The squared distance at which this collapse costs as much as that.
        float squared_distance_at(float cost) const { return cost > extra ? (cost - extra) * (cost - extra) : 0; }
        // Infinite also where the sum is not a number, in meshes whose squares floats cannot hold.
        float cost() const {
            const float all = std::sqrt(squared_distance) + extra;
            return all < kNever ? all : kNever;
        }
    };

    TriangleInPoses triangle_of(const std::array<uint32_t, 3>& corners, size_t group) const {
        return {mesh_.places(corners[0])[group], mesh_.places(corners[1])[group], mesh_.places(corners[2])[group]};
    }

    std::vector<uint32_t> neighbours_of(uint32_t point) const {
        std::vector<uint32_t> neighbours;
        for (const uint32_t face : points_[point].faces)
            for (const uint32_t other : faces_[face].points)
                if (other != point) neighbours.push_back(other);
        erase_copies(neighbours);
        return neighbours;
    }

    // Decides where a point would go by what that costs in the first poses, and puts it into the queue. Most often it
    // is outdated before it comes to the front, and nothing else needs to be known of it.
    void plan(uint32_t from) {
        Point& point = points_[from];
        point.target = kNone;
        point.is_outdated = point.is_measured = false;
        ++point.version;
        if (point.faces.size() > kMostFaces) return;
        const std::vector<Collapse> all = possible_collapses(from);
        if (all.empty()) return;
        point.target = all[0].to;
        point.others_cost = all.size() > 1 ? all[1].cost() : kNever;
        queue_.push({all[0].cost(), from, point.version});
    }

    // Decides it by all poses, and both ways.
    void confirm(uint32_t from) {
        Point& point = points_[from];
        find_lost(from);
        Collapse best = collapse_of(from, point.target);
        measure(from, best, kNever);
        if (best.cost() > point.others_cost) {
            for (Collapse& one : possible_collapses(from)) {
                if (one.cost() >= best.cost()) break;
                if (one.to == point.target) continue;
                measure(from, one, best.cost());
                if (one.cost() < best.cost()) best = one;
            }
        }
        point.target = best.cost() < kNever ? best.to : kNone;
        point.is_measured = true;
        ++point.version;
        if (point.target == kNone) return;
        queue_.push({best.cost(), from, point.version});
    }

    // The least first, by the first poses; of all but the first two it is only known that they cost no less.
    std::vector<Collapse> possible_collapses(uint32_t from) {
        find_lost(from);
        std::vector<Collapse> all;
        float least = kNever, second = kNever;
        for (const uint32_t to : neighbours_of(from)) {
            Collapse one = collapse_of(from, to);
            if (points_[to].faces.size() > kMostFaces || !try_moving(from, one)) continue;
            one.squared_distance = distance_of_lost(0, one.squared_distance_at(second));
            const float cost = one.cost();
            if (cost >= kNever) continue;
            all.push_back(one);
            second = std::min(second, std::max(least, cost));
            least = std::min(least, cost);
        }
        std::ranges::sort(all, {}, &Collapse::cost);
        return all;
    }

    Collapse collapse_of(uint32_t from, uint32_t to) const {
        return {.to = to, .extra = kLengthWeight * length(mesh_.rest_place(from) - mesh_.rest_place(to))};
    }

    // What the triangles around a point stand for.
    void find_lost(uint32_t from) {
        lost_.assign(1, from);
        for (const uint32_t face : points_[from].faces)
            lost_.insert(lost_.end(), faces_[face].lost.begin(), faces_[face].lost.end());
    }

    // Fills moved_ with the triangles that move. False where one would turn over, leave its section, or be there twice,
    // or where another point would lose its last one.
    bool try_moving(uint32_t from, Collapse& collapse) {
        moved_.clear();
        for (const uint32_t face : points_[from].faces) {
            if (faces_[face].has(collapse.to)) {
                const auto is_last = [&](uint32_t point) {
                    return point != from && point != collapse.to && points_[point].faces.size() == 1;
                };
                if (std::ranges::any_of(faces_[face].points, is_last)) return false;
                continue;
            }
            WeldedFace moved = faces_[face];
            for (size_t k = 0; k < 3; ++k) {
                if (moved.points[k] != from) continue;
                const WeldedMesh::Corner corner = mesh_.most_like(moved.vertices[k], collapse.to);
                if (corner.vertex == kNone) return false;
                moved.points[k] = collapse.to;
                moved.vertices[k] = corner.vertex;
                if (!corner.is_of_same_chart) collapse.extra = std::max(collapse.extra, height_of(moved.points));
            }
            const auto is_same = [&](uint32_t other) {
                return std::ranges::all_of(moved.points, [&](uint32_t point) { return faces_[other].has(point); });
            };
            if (std::ranges::any_of(points_[collapse.to].faces, is_same)) return false;
            if (turns(faces_[face].points, moved.points)) return false;
            moved_.push_back(moved.points);
        }
        return !moved_.empty();
    }

    Vec3<float> rest_normal(const std::array<uint32_t, 3>& corners) const {
        const Vec3<float> a = mesh_.rest_place(corners[0]);
        return cross(mesh_.rest_place(corners[1]) - a, mesh_.rest_place(corners[2]) - a);
    }
    bool turns(const std::array<uint32_t, 3>& before, const std::array<uint32_t, 3>& after) const {
        const Vec3<float> normal = rest_normal(before), moved = rest_normal(after);
        return dot(normal, moved) <= kTurned * length(normal) * length(moved);
    }
    // Of a triangle, the least of three: what is painted wrong where it is.
    float height_of(const std::array<uint32_t, 3>& corners) const {
        float longest = 0;
        for (size_t k = 0; k < 3; ++k)
            longest = std::max(longest, length(mesh_.rest_place(corners[(k + 1) % 3]) - mesh_.rest_place(corners[k])));
        return longest > 0 ? length(rest_normal(corners)) / longest : 0;
    }

    // Squared: how far lost_ lie from moved_ at most in a group of poses, unless it is more than `useful`.
    float distance_of_lost(size_t group, float useful) {
        triangles_.clear();
        for (const auto& [a, b, c] : moved_)
            triangles_.emplace_back(mesh_.places(a)[group], mesh_.places(b)[group], mesh_.places(c)[group]);
        Four furthest{};
        for (const uint32_t point : lost_) {
            const Four3 place = mesh_.places(point)[group];
            Four nearest = triangles_[0].squared_distance(place);
            for (size_t i = 1; i < triangles_.size(); ++i)
                nearest = lower(nearest, triangles_[i].squared_distance(place));
            furthest = higher(furthest, nearest);
            if (largest(furthest) > useful) break;
        }
        return largest(furthest);
    }

    // In all poses, and both ways, as long as it may cost less than `least`.
    void measure(uint32_t from, Collapse& collapse, float least) {
        try_moving(from, collapse);
        const float useful = collapse.squared_distance_at(least);
        for (size_t group = 0; group < mesh_.groups() && collapse.squared_distance < useful; ++group)
            collapse.squared_distance = std::max(collapse.squared_distance, distance_of_lost(group, useful));
        if (collapse.squared_distance < useful) measure_middles(collapse);
    }

    // Of triangles that have moved, and of their edges that have, from the fine mesh: from what is nearest at rest.
    void measure_middles(Collapse& collapse) {
        uint32_t guess = points_[collapse.to].near_triangle;
        ends_.clear();
        for (const auto& corners : moved_) {
            measure_middle(corners, 1 / 3.0f, guess, collapse);
            for (const uint32_t end : corners) {
                if (end == collapse.to || std::ranges::find(ends_, end) != ends_.end()) continue;
                ends_.push_back(end);
                measure_middle({collapse.to, end, kNone}, 1 / 2.0f, guess, collapse);
            }
        }
    }
    void measure_middle(const std::array<uint32_t, 3>& ends, float part, uint32_t& guess, Collapse& collapse) {
        const auto middle_in = [&](size_t group) {
            Four3 sum = mesh_.places(ends[0])[group] + mesh_.places(ends[1])[group];
            if (ends[2] != kNone) sum = sum + mesh_.places(ends[2])[group];
            return sum * four(part);
        };
        const float near_enough = kNearEnough * collapse.cost();
        guess = fine_.nearest(middle_in(0).in_pose(0), near_enough * near_enough, guess).triangle;
        std::array<uint32_t, 3> corners;
        for (size_t k = 0; k < 3; ++k) corners[k] = mesh_.point_of(fine_.corners()[guess][k]);
        for (size_t group = 0; group < mesh_.groups(); ++group)
            collapse.squared_distance = std::max(
                collapse.squared_distance, largest(triangle_of(corners, group).squared_distance(middle_in(group))));
    }

    void collapse(uint32_t from, uint32_t to) {
        std::vector<uint32_t> lost{from}, changed{to};
        for (const uint32_t at : points_[from].faces) {
            Face& face = faces_[at];
            lost.insert(lost.end(), face.lost.begin(), face.lost.end());
            face.lost.clear();
            if (face.has(to)) {
                face.is_there = false;
                --face_count_;
                for (const uint32_t point : face.points) {
                    if (point == from) continue;
                    std::erase(points_[point].faces, at);
                    changed.push_back(point);
                    if (points_[point].faces.size() == 1)  // which those beside it may not take
                        for (const uint32_t beside : neighbours_of(point)) changed.push_back(beside);
                }
                continue;
            }
            for (size_t k = 0; k < 3; ++k) {
                if (face.points[k] != from) continue;
                face.points[k] = to;
                face.vertices[k] = mesh_.most_like(face.vertices[k], to).vertex;
            }
            points_[to].faces.push_back(at);
        }
        points_[from] = {.version = points_[from].version + 1};
        for (const uint32_t point : lost) faces_[nearest_face(point, points_[to].faces)].lost.push_back(point);
        for (const uint32_t face : points_[to].faces) faces_[face].forget();
        for (const uint32_t point : neighbours_of(to)) changed.push_back(point);
        erase_copies(changed);
        for (const uint32_t point : changed) {
            points_[point].is_outdated = true;
            if (points_[point].target == kNone) plan(point);  // what was not possible may be now
        }
    }

    uint32_t nearest_face(uint32_t point, std::span<const uint32_t> faces) const {
        uint32_t best = faces[0];
        float least = kNever;
        for (const uint32_t face : faces) {
            float furthest = 0;
            for (size_t group = 0; group < mesh_.groups(); ++group)
                furthest = std::max(
                    furthest,
                    largest(triangle_of(faces_[face].points, group).squared_distance(mesh_.places(point)[group])));
            if (furthest < least) least = furthest, best = face;
        }
        return best;
    }

    WeldedMesh mesh_;
    TriangleIndex fine_;  // at rest
    std::vector<Face> faces_;
    size_t face_count_;
    std::vector<Point> points_;
    std::priority_queue<Planned> queue_;
    // Of the collapse that is looked at
    std::vector<uint32_t> lost_;                  // points that its triangles stand for
    std::vector<std::array<uint32_t, 3>> moved_;  // points of triangles
    std::vector<uint32_t> ends_;                  // of edges that have been measured
    std::vector<TriangleInPoses> triangles_;      // moved_, in a group of poses
};

}  // namespace

std::vector<std::vector<uint32_t>> decimate(const Character& character, std::span<const uint32_t> indices,
                                            std::span<const std::vector<Vec3<float>>> positions,
                                            std::span<const size_t> index_counts, const Progress& progress) {
    constexpr double kPlanned = 0.3;  // part of the work
    Decimation decimation(character, indices, positions);
    decimation.plan_all(progress.between(0, kPlanned));
    std::vector<std::vector<uint32_t>> meshes;
    for (const size_t count : index_counts) {
        decimation.collapse_to(count / 3, progress.between(kPlanned, 1));
        meshes.push_back(decimation.indices());
    }
    return meshes;
}

}  // namespace throng
