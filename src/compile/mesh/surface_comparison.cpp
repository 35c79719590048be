#include "compile/mesh/surface_comparison.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace throng {
namespace {

// The weights of a triangle's corners in its nearest point to p (C. Ericson, Real-Time Collision Detection, 2005,
// 5.1.5).
std::array<float, 3> nearest_weights(const Vec3<float>& p, const Vec3<float>& a, const Vec3<float>& b,
                                     const Vec3<float>& c) {
    const Vec3<float> ab = b - a, ac = c - a;
    const float ab_a = dot(ab, p - a), ac_a = dot(ac, p - a), ab_b = dot(ab, p - b), ac_b = dot(ac, p - b),
                ab_c = dot(ab, p - c), ac_c = dot(ac, p - c);
    if (ab_a <= 0 && ac_a <= 0) return {1, 0, 0};
    if (ab_b >= 0 && ac_b <= ab_b) return {0, 1, 0};
    if (ac_c >= 0 && ab_c <= ac_c) return {0, 0, 1};
    const float of_a = ab_b * ac_c - ab_c * ac_b, of_b = ab_c * ac_a - ab_a * ac_c, of_c = ab_a * ac_b - ab_b * ac_a;
    if (of_c <= 0 && ab_a >= 0 && ab_b <= 0) return {ab_b / (ab_b - ab_a), ab_a / (ab_a - ab_b), 0};
    if (of_b <= 0 && ac_a >= 0 && ac_c <= 0) return {ac_c / (ac_c - ac_a), 0, ac_a / (ac_a - ac_c)};
    const float from_b = ac_b - ab_b, from_c = ab_c - ac_c;
    if (of_a <= 0 && from_b >= 0 && from_c >= 0) return {0, from_c / (from_b + from_c), from_b / (from_b + from_c)};
    const float sum = of_a + of_b + of_c;
    return {of_a / sum, of_b / sum, of_c / sum};
}

std::vector<uint32_t> distinct_vertices(const TriangleIndex& surface, size_t vertex_count) {
    std::vector<bool> is_known(vertex_count);
    std::vector<uint32_t> distinct;
    for (const std::array<uint32_t, 3>& corners : surface.corners()) {
        for (const uint32_t vertex : corners) {
            if (is_known[vertex]) continue;
            is_known[vertex] = true;
            distinct.push_back(vertex);
        }
    }
    return distinct;
}

}  // namespace

SurfaceComparison::SurfaceComparison(CoarseMesh& coarse, const PosedMesh& fine)
    : coarse_(coarse),
      fine_(fine),
      fine_vertices_(distinct_vertices(fine.surfaces[0], fine.positions[0].size())),
      near_(fine.pose_count(), std::vector<Near>(place_count())) {}

Vec3<float> SurfaceComparison::place(size_t number, uint32_t pose) const {
    return is_fine(number) ? fine_.positions[pose][fine_vertices_[number]]
                           : coarse_.places()[number - fine_vertices_.size()].in(coarse_.positions(pose));
}

const TriangleIndex& SurfaceComparison::other_surface(size_t number, uint32_t pose) const {
    return is_fine(number) ? coarse_.surface() : fine_.surfaces[pose];
}

// Returns the squared distance of a place, or any that is no larger than `near_enough`, also a squared distance.
float SurfaceComparison::search(size_t number, uint32_t pose, float near_enough) {
    Near& near = near_[pose][number];
    const TriangleIndex::Nearest found =
        other_surface(number, pose).nearest(place(number, pose), near_enough, near.triangle);
    near = {found.triangle, std::sqrt(found.squared_distance)};
    steps_ += found.steps;
    return found.squared_distance;
}

float SurfaceComparison::largest_distance(const Progress& progress) {
    float furthest = 0;  // squared
    for (uint32_t pose = 0; pose < fine_.pose_count(); ++pose) {
        coarse_.move_surface(pose);
        std::vector<Near>& near = near_[pose];
        for (size_t number = 0; number < near.size(); ++number) {
            progress.poll_at(number);
            // A guess: what was near it in the last pose, or near the neighbour
            const bool is_first = number == 0 || is_fine(number) != is_fine(number - 1);
            near[number].triangle = pose > 0   ? near_[pose - 1][number].triangle
                                    : is_first ? 0
                                               : near[number - 1].triangle;
            furthest = std::max(furthest, search(number, pose, furthest));
        }
        note_movement(pose);
    }
    return std::sqrt(furthest);
}

// Sets moved_by_, and begins anew.
void SurfaceComparison::note_movement(uint32_t pose) {
    const std::span<const Vec3<float>> now = coarse_.positions(pose);
    known_.resize(fine_.pose_count());
    known_[pose].resize(now.size());
    moved_by_.resize(now.size());
    for (size_t vertex = 0; vertex < now.size(); ++vertex) {
        moved_by_[vertex] = length(now[vertex] - known_[pose][vertex]);
        known_[pose][vertex] = now[vertex];
    }
}

// By how much more a place may be away from what was near it: as far as the corners of its triangle have moved, or of
// the triangle near it.
float SurfaceComparison::movement(size_t number, const Near& near) const {
    const std::array<uint32_t, 3>& corners = is_fine(number)
                                                 ? coarse_.surface().corners()[near.triangle]
                                                 : coarse_.places()[number - fine_vertices_.size()].vertices;
    return std::max({moved_by_[corners[0]], moved_by_[corners[1]], moved_by_[corners[2]]});
}

std::vector<PlacePair> SurfaceComparison::pairs_beyond(float distance, const Progress& progress) {
    std::vector<PlacePair> pairs;
    for (uint32_t pose = 0; pose < fine_.pose_count(); ++pose) {
        coarse_.move_surface(pose);
        note_movement(pose);
        for (size_t number = 0; number < near_[pose].size(); ++number) {
            progress.poll_at(number);
            Near& near = near_[pose][number];
            near.distance += movement(number, near);
            if (near.distance <= distance || !(search(number, pose, distance * distance) > distance * distance))
                continue;
            PlacePair& pair = pairs.emplace_back(PlacePair{.pose = pose, .number = number, .triangle = near.triangle});
            if (!is_fine(number)) pair.coarse = coarse_.places()[number - fine_vertices_.size()];
            update(pair);
        }
    }
    return pairs;
}

void SurfaceComparison::update(PlacePair& pair) const {
    const std::array<uint32_t, 3>& corners = other_surface(pair.number, pair.pose).corners()[pair.triangle];
    const std::span<const Vec3<float>> positions = is_fine(pair.number) ? coarse_.positions(pair.pose)
                                                                        : fine_.positions[pair.pose];
    const Vec3<float> from = place(pair.number, pair.pose);
    const CoarseMesh::Place nearest{
        corners, nearest_weights(from, positions[corners[0]], positions[corners[1]], positions[corners[2]])};
    const Vec3<float> way = nearest.in(positions)-from;
    if (is_fine(pair.number)) pair.coarse = nearest;
    pair.apart = is_fine(pair.number) ? way * -1.0f : way;
}

}  // namespace throng
