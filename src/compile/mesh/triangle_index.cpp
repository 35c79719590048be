#include "compile/mesh/triangle_index.h"

#include "base/count.h"

#include <algorithm>
#include <type_traits>

namespace throng {
namespace {

constexpr size_t kLeafTriangles = 4;
constexpr size_t kDeepest = 64;  // boxes that wait, one a level: more than 2^32 triangles have

Vec3<float> lower(const Vec3<float>& a, const Vec3<float>& b) {
    return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)};
}
Vec3<float> higher(const Vec3<float>& a, const Vec3<float>& b) {
    return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)};
}

// Rounding is monotonic: of a box within another one this is not less than of the other.
float squared_distance_from_box(const Vec3<float>& p, const Vec3<float>& low, const Vec3<float>& high) {
    const Vec3<float> apart = higher(higher(low - p, p - high), {0, 0, 0});
    return dot(apart, apart);
}

float squared_distance_from_box(const Vec3<float>& p, const Triangle& t) {
    return squared_distance_from_box(p, lower(lower(t[0], t[1]), t[2]), higher(higher(t[0], t[1]), t[2]));
}

// From its plane where the point is above it, else from an edge. Floats round away where the normal of a thin triangle
// points, so that is looked at in double precision; and what is too thin for that is its edges.
template <class T>
T squared_distance_from_surface(const Vec3<T>& p, const Vec3<T>& a, const Vec3<T>& b, const Vec3<T>& c) {
    constexpr bool is_single = std::is_same_v<T, float>;
    constexpr T kThin = is_single ? T(1e-4) : T(1e-20);  // the squared sine of the angle at a
    const Vec3<T> ab = b - a, ac = c - a, normal = cross(ab, ac);
    const T squared = dot(normal, normal);
    bool is_above = squared > kThin * dot(ab, ab) * dot(ac, ac);
    if constexpr (is_single)
        if (!is_above)
            return static_cast<float>(squared_distance_from_surface(p.template as<double>(), a.template as<double>(),
                                                                    b.template as<double>(), c.template as<double>()));
    T nearest = std::numeric_limits<T>::infinity();
    const auto look_at_edge = [&](const Vec3<T>& from, const Vec3<T>& to) {
        const Vec3<T> edge = to - from, way = p - from;
        is_above = is_above && dot(cross(edge, way), normal) >= 0;
        const T length_squared = dot(edge, edge);
        const T at = length_squared > 0 ? std::clamp(dot(way, edge) / length_squared, T(0), T(1)) : T(0);
        const Vec3<T> apart = way - edge * at;
        nearest = std::min(nearest, dot(apart, apart));
    };
    look_at_edge(a, b);
    look_at_edge(b, c);
    look_at_edge(c, a);
    const T height = dot(p - a, normal);
    return is_above ? height * height / squared : nearest;
}

}  // namespace

float squared_distance(const Vec3<float>& p, const Triangle& t) {
    return std::max(squared_distance_from_box(p, t), squared_distance_from_surface(p, t[0], t[1], t[2]));
}

TriangleIndex::TriangleIndex(std::span<const uint32_t> indices, std::span<const Vec3<float>> positions)
    : triangles_(indices.size() / 3), corners_(triangles_.size()), leaves_(triangles_.size()) {
    if (corners_.empty()) return;
    std::vector<Centroid> centroids;
    centroids.reserve(corners_.size());
    for (uint32_t t = 0; t < corners_.size(); ++t)
        centroids.push_back(
            {positions[indices[3 * t]] + positions[indices[3 * t + 1]] + positions[indices[3 * t + 2]], t});
    nodes_.reserve(corners_.size());
    split(centroids, 0, 0);
    for (size_t t = 0; t < corners_.size(); ++t)
        for (size_t k = 0; k < 3; ++k) corners_[t][k] = indices[3 * size_t{centroids[t].triangle} + k];
    move(positions);
}

// Into halves of equal number, along the longest side of their box.
void TriangleIndex::split(std::span<Centroid> centroids, uint32_t first, uint32_t parent) {
    const auto at = count_of(nodes_);
    nodes_.push_back({.first = first, .count = count_of(centroids), .parent = parent});
    if (centroids.size() <= kLeafTriangles) {
        std::fill_n(leaves_.begin() + first, centroids.size(), at);
        return;
    }
    Vec3<float> low = centroids[0].place, high = low;
    for (const Centroid& one : centroids) low = lower(low, one.place), high = higher(high, one.place);
    const Vec3<float> extent = high - low;
    float Vec3<float>::*axis = &Vec3<float>::x;
    for (float Vec3<float>::*other : {&Vec3<float>::y, &Vec3<float>::z})
        if (extent.*other > extent.*axis) axis = other;
    const size_t half = centroids.size() / 2;
    std::ranges::nth_element(
        centroids, centroids.begin() + static_cast<std::ptrdiff_t>(half), [axis](const Centroid& a, const Centroid& b) {
            return a.place.*axis != b.place.*axis ? a.place.*axis < b.place.*axis : a.triangle < b.triangle;
        });
    split(centroids.first(half), first, at);
    nodes_[at].count = 0;
    nodes_[at].first = count_of(nodes_);
    split(centroids.subspan(half), first + static_cast<uint32_t>(half), at);
}

void TriangleIndex::move(std::span<const Vec3<float>> positions) {
    for (size_t t = 0; t < corners_.size(); ++t)
        for (size_t k = 0; k < 3; ++k) triangles_[t][k] = positions[corners_[t][k]];
    for (size_t at = nodes_.size(); at-- > 0;) {
        Node& node = nodes_[at];
        if (node.count == 0) {
            node.low = lower(nodes_[at + 1].low, nodes_[node.first].low);
            node.high = higher(nodes_[at + 1].high, nodes_[node.first].high);
            continue;
        }
        node.low = node.high = triangles_[node.first][0];
        for (uint32_t t = node.first; t < node.first + node.count; ++t)
            for (const Vec3<float>& corner : triangles_[t])
                node.low = lower(node.low, corner), node.high = higher(node.high, corner);
    }
}

void TriangleIndex::look_at(const Vec3<float>& p, uint32_t triangle, Nearest& best) const {
    ++best.steps;
    const auto& [a, b, c] = triangles_[triangle];
    const float least = squared_distance_from_box(p, triangles_[triangle]);
    if (!(least < best.squared_distance)) return;
    const float distance = std::max(least, squared_distance_from_surface(p, a, b, c));
    if (distance < best.squared_distance) best.squared_distance = distance, best.triangle = triangle;
}

// The nearer half first.
void TriangleIndex::search_below(uint32_t top, const Vec3<float>& p, float enough, Nearest& best) const {
    struct Waiting {
        uint32_t node;
        float squared_distance;
    };
    const auto waiting_for = [&](uint32_t node) {
        ++best.steps;
        return Waiting{node, squared_distance_from_box(p, nodes_[node].low, nodes_[node].high)};
    };
    std::array<Waiting, kDeepest> waiting;
    waiting[0] = waiting_for(top);
    for (size_t count = 1; count > 0 && best.squared_distance > enough;) {
        const Waiting next = waiting[--count];
        if (!(next.squared_distance < best.squared_distance)) continue;
        const Node& node = nodes_[next.node];
        for (uint32_t t = node.first; t < node.first + node.count; ++t) look_at(p, t, best);
        if (node.count > 0) continue;
        Waiting near = waiting_for(next.node + 1), far = waiting_for(node.first);
        if (far.squared_distance < near.squared_distance) std::swap(near, far);
        waiting[count++] = far;
        waiting[count++] = near;
    }
}

TriangleIndex::Nearest TriangleIndex::nearest(const Vec3<float>& p, float enough, uint32_t guess) const {
    Nearest best;
    if (triangles_.empty()) return best;
    look_at(p, guess, best);
    if (best.squared_distance <= enough) return best;
    // The smallest box around the guess in which a triangle may be near enough; then what is beside it.
    uint32_t at = leaves_[guess];
    for (; at != 0 && squared_distance_from_box(p, nodes_[at].low, nodes_[at].high) > enough; ++best.steps)
        at = nodes_[at].parent;
    search_below(at, p, enough, best);
    for (; at != 0 && best.squared_distance > enough; at = nodes_[at].parent) {
        const uint32_t parent = nodes_[at].parent;
        search_below(at == parent + 1 ? nodes_[parent].first : parent + 1, p, enough, best);
    }
    return best;
}

}  // namespace throng
