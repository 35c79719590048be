#include "compile/mesh/surface_comparison.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <unordered_set>

namespace throng {
namespace {

// The weights of a triangle's corners in its nearest point to p (C. Ericson, Real-Time Collision Detection, 2005,
// 5.1.5). In double precision, since triangles may be thin.
std::array<double, 3> nearest_weights(const Vec3<double>& p, const Vec3<double>& a, const Vec3<double>& b,
                                      const Vec3<double>& c) {
    const Vec3<double> ab = b - a, ac = c - a;
    const double ab_a = dot(ab, p - a), ac_a = dot(ac, p - a), ab_b = dot(ab, p - b), ac_b = dot(ac, p - b),
                 ab_c = dot(ab, p - c), ac_c = dot(ac, p - c);
    if (ab_a <= 0 && ac_a <= 0) return {1, 0, 0};
    if (ab_b >= 0 && ac_b <= ab_b) return {0, 1, 0};
    if (ac_c >= 0 && ab_c <= ac_c) return {0, 0, 1};
    const double of_a = ab_b * ac_c - ab_c * ac_b, of_b = ab_c * ac_a - ab_a * ac_c, of_c = ab_a * ac_b - ab_b * ac_a;
    if (of_c <= 0 && ab_a >= 0 && ab_b <= 0) return {ab_b / (ab_b - ab_a), ab_a / (ab_a - ab_b), 0};
    if (of_b <= 0 && ac_a >= 0 && ac_c <= 0) return {ac_c / (ac_c - ac_a), 0, ac_a / (ac_a - ac_c)};
    const double from_b = ac_b - ab_b, from_c = ab_c - ac_c;
    if (of_a <= 0 && from_b >= 0 && from_c >= 0) return {0, from_c / (from_b + from_c), from_b / (from_b + from_c)};
    const double sum = of_a + of_b + of_c;
    return {of_a / sum, of_b / sum, of_c / sum};
}

// A place is not searched for in other poses if the triangle known there is at most this many times as far away as the
// nearest one in its worst pose.
constexpr float kAlmostNearest = 1.1f;

}  // namespace

SurfaceComparison::SurfaceComparison(const CoarseMesh& coarse)
    : coarse_(coarse), fine_(coarse.fine()), welded_(coarse.welded()), near_(fine_.pose_count()) {
    std::vector<Vec3<float>> at_rest;
    for (uint32_t vertex = 0; vertex < coarse.sources().size(); ++vertex) at_rest.push_back(coarse.position(vertex, 0));
    coarse_surfaces_.assign(fine_.pose_count(), TriangleIndex(coarse.indices(), at_rest));
    make_coarse_places();
    likely_.assign(place_count(), kNone);
}

void SurfaceComparison::make_coarse_places() {
    constexpr float kThird = 1.0f / 3, kHalf = 0.5f;
    std::vector<bool> is_known(coarse_.shifts().size());  // [points]
    std::unordered_set<uint64_t> edges;                   // pairs of points
    for (const std::array<uint32_t, 3>& corners : coarse_surfaces_[0].corners()) {
        coarse_places_.push_back({corners, {kThird, kThird, kThird}});
        for (size_t k = 0; k < 3; ++k) {
            const uint32_t a = corners[k], b = corners[(k + 1) % 3];
            const uint32_t from = coarse_.point_of(a), to = coarse_.point_of(b);
            if (edges.insert(uint64_t{std::min(from, to)} << 32 | std::max(from, to)).second)
                coarse_places_.push_back({{a, b, a}, {kHalf, kHalf, 0}});
            if (!is_known[from]) coarse_places_.push_back({{a, a, a}, {1, 0, 0}});
            is_known[from] = true;
        }
    }
}

void SurfaceComparison::move_surfaces() {
    std::vector<Vec3<float>> positions(coarse_.sources().size());
    for (uint32_t pose = 0; pose < coarse_surfaces_.size(); ++pose) {
        for (uint32_t vertex = 0; vertex < positions.size(); ++vertex)
            positions[vertex] = coarse_.position(vertex, pose);
        coarse_surfaces_[pose].move(positions);
    }
}

Four3 SurfaceComparison::places(size_t number, size_t group) const {
    return is_fine(number) ? welded_.places(static_cast<uint32_t>(number))[group]
                           : coarse_.positions(coarse_place(number), group);
}

const TriangleIndex& SurfaceComparison::other_surface(size_t number, uint32_t pose) const {
    return is_fine(number) ? coarse_surfaces_[pose] : fine_.surfaces[pose];
}

SurfaceComparison::Result SurfaceComparison::compare(float part, float least, const Progress& progress) {
    move_surfaces();
    Result result;
    squared_part_ = part * part, squared_least_ = least * least, squared_largest_ = 0;
    // Looks at some places first: where little is known of the largest distance, more has to be searched for
    constexpr size_t kSome = 16;
    for (size_t number = 0; number < place_count(); number += kSome) {
        progress.poll_at(number * near_.size());
        look_at(number);
    }
    for (size_t number = 0; number < place_count(); ++number) {
        progress.poll_at(number * near_.size());
        look_at(number);
        for (uint32_t pose = 0; pose < near_.size(); ++pose) {
            if (near_[pose].squared_distance <= std::max(squared_part_ * squared_largest_, squared_least_)) continue;
            PlacePair& pair = result.pairs.emplace_back(
                PlacePair{.pose = pose, .number = number, .triangle = near_[pose].triangle});
            if (!is_fine(number)) pair.coarse = coarse_place(number);
            update(pair);
        }
    }
    result.largest = std::sqrt(squared_largest_);
    const float far = std::max(part * result.largest, least);
    std::erase_if(result.pairs, [&](const PlacePair& pair) { return !(length(pair.apart) > far); });
    return result;
}

// No place within this distance can be the furthest one or belong to a pair, so none is searched for.
float SurfaceComparison::squared_near_enough() const {
    return std::max(squared_part_ * squared_largest_, std::min(squared_least_, squared_largest_));
}

// Sets near_.
void SurfaceComparison::look_at(size_t number) {
    // A guess: what was near it before, or near its neighbour
    uint32_t& likely = likely_[number];
    if (likely == kNone) likely = number == 0 || is_fine(number) != is_fine(number - 1) ? 0 : likely_[number - 1];
    if (likely == kNone) likely = 0;
    near_.assign(near_.size(), {.squared_distance = std::numeric_limits<float>::infinity()});
    try_triangle(number, likely);
    float squared_furthest = 0;  // of the poses that have been searched
    while (true) {
        uint32_t pose = kNone;  // the one that is the farthest, as far as is known
        for (uint32_t other = 0; other < near_.size(); ++other)
            if (!near_[other].is_searched &&
                (pose == kNone || near_[other].squared_distance > near_[pose].squared_distance))
                pose = other;
        if (pose == kNone) return;
        const float known = near_[pose].squared_distance, enough = squared_near_enough();
        if (known <= enough) return;
        if (known <= squared_largest_ && known <= kAlmostNearest * kAlmostNearest * squared_furthest) return;
        search(number, pose, enough);
        const float found = near_[pose].squared_distance;
        // Only what is not near enough is the exact distance
        if (found > enough) squared_furthest = std::max(squared_furthest, found);
        squared_largest_ = std::max(squared_largest_, found);
        if (near_[pose].triangle == likely) continue;
        likely = near_[pose].triangle;
        try_triangle(number, likely);
    }
}

void SurfaceComparison::try_triangle(size_t number, uint32_t triangle) {
    const std::array<uint32_t, 3>& corners = other_surface(number, 0).corners()[triangle];
    std::array<const Four3*, 3> in_poses;
    for (size_t k = 0; k < 3; ++k)
        in_poses[k] = is_fine(number) ? coarse_.positions(corners[k]) : welded_.places(welded_.point_of(corners[k]));
    for (uint32_t pose = 0; pose < near_.size(); pose += kLanes) {
        const size_t group = pose / kLanes;
        const Four distances = squared_distances(places(number, group), in_poses[0][group], in_poses[1][group],
                                                 in_poses[2][group]);
        for (uint32_t lane = 0; lane < kLanes && pose + lane < near_.size(); ++lane)
            if (Near& near = near_[pose + lane]; !near.is_searched && distances[lane] < near.squared_distance)
                near = {triangle, distances[lane], false};
    }
}

// Finds the nearest triangle, or any that is no farther than enough.
void SurfaceComparison::search(size_t number, uint32_t pose, float squared_enough) {
    const TriangleIndex::Nearest found =
        other_surface(number, pose).nearest(place(number, pose), squared_enough, near_[pose].triangle);
    near_[pose] = {found.triangle, found.squared_distance, true};
    steps_ += found.steps;
}

void SurfaceComparison::update(PlacePair& pair) const {
    const std::array<uint32_t, 3>& corners = other_surface(pair.number, pair.pose).corners()[pair.triangle];
    std::array<Vec3<float>, 3> triangle;
    for (size_t k = 0; k < 3; ++k)
        triangle[k] = is_fine(pair.number) ? coarse_.position(corners[k], pair.pose)
                                           : fine_.positions[pair.pose][corners[k]];
    const Vec3<float> from = place(pair.number, pair.pose);
    const std::array<double, 3> exact = nearest_weights(from.as<double>(), triangle[0].as<double>(),
                                                        triangle[1].as<double>(), triangle[2].as<double>());
    std::array<float, 3> weights;
    for (size_t k = 0; k < 3; ++k) weights[k] = static_cast<float>(exact[k]);
    const Vec3<float> way = triangle[0] * weights[0] + triangle[1] * weights[1] + triangle[2] * weights[2] - from;
    if (is_fine(pair.number)) pair.coarse = {corners, weights};
    pair.apart = is_fine(pair.number) ? way * -1.0f : way;
}

}  // namespace throng
