#include "compile/mesh/triangle_index.h"

#include "base/count.h"

#include <algorithm>

namespace throng {
namespace {

constexpr float kNowhere = std::numeric_limits<float>::infinity();
constexpr size_t kDeepest = 64;  // waiting parts: three per level, enough for 2^32 triangles

// Rounding is monotonic, so a box inside another one never gets a smaller result than the outer one.
Four squared_distance_from_box(const Four3& p, const Four3& low, const Four3& high) {
    const Four3 apart = higher(four(Vec3<float>{0, 0, 0}), higher(low - p, p - high));
    return dot(apart, apart);
}

// Measures from the triangle's plane if the point is above the triangle, else from the nearest edge.
double squared_distance_from_thin(const Vec3<double>& p, const Vec3<double>& a, const Vec3<double>& b,
                                  const Vec3<double>& c) {
    constexpr double kThin = 1e-20;  // squared sine of the angle at a; below it, only the edges count
    const Vec3<double> ab = b - a, ac = c - a, normal = cross(ab, ac);
    const double squared = dot(normal, normal);
    bool is_above = squared > kThin * dot(ab, ab) * dot(ac, ac);
    double nearest = std::numeric_limits<double>::infinity();
    const auto look_at_edge = [&](const Vec3<double>& from, const Vec3<double>& to) {
        const Vec3<double> edge = to - from, way = p - from;
        is_above = is_above && dot(cross(edge, way), normal) >= 0;
        const double length_squared = dot(edge, edge);
        const double at = length_squared > 0 ? std::clamp(dot(way, edge) / length_squared, 0.0, 1.0) : 0.0;
        const Vec3<double> apart = way - edge * at;
        nearest = std::min(nearest, dot(apart, apart));
    };
    look_at_edge(a, b);
    look_at_edge(b, c);
    look_at_edge(c, a);
    const double height = dot(p - a, normal);
    return is_above ? height * height / squared : nearest;
}

}  // namespace

Four squared_distances(const Four3& p, const Four3& a, const Four3& b, const Four3& c) {
    // Floats cannot tell where the normal of a thin triangle points: thin ones are measured in double precision
    constexpr float kThin = 1e-4f;
    const FourTriangles triangles(a, b, c);
    Four distances = triangles.squared_distance(p);
    const FourFlags is_thin = ~(triangles.squared_sine() > kThin);
    if (is_any(is_thin)) {
        for (size_t k = 0; k < kLanes; ++k)
            if (is_thin[k] != 0)
                distances[k] = static_cast<float>(squared_distance_from_thin(
                    p.at(k).as<double>(), a.at(k).as<double>(), b.at(k).as<double>(), c.at(k).as<double>()));
    }
    return higher(distances, squared_distance_from_box(p, lower(lower(a, b), c), higher(higher(a, b), c)));
}

float squared_distance(const Vec3<float>& p, const Triangle& t) {
    return squared_distances(four(p), four(t[0]), four(t[1]), four(t[2]))[0];
}

TriangleIndex::TriangleIndex(std::span<const uint32_t> indices, std::span<const Vec3<float>> positions)
    : corners_(indices.size() / 3), leaf_of_(corners_.size()) {
    if (corners_.empty()) return;
    std::vector<Centroid> centroids;
    centroids.reserve(corners_.size());
    for (uint32_t t = 0; t < corners_.size(); ++t)
        centroids.push_back(
            {positions[indices[3 * t]] + positions[indices[3 * t + 1]] + positions[indices[3 * t + 2]], t});
    add_part(centroids, 0, 0, 0);
    for (size_t t = 0; t < corners_.size(); ++t)
        for (size_t k = 0; k < 3; ++k) corners_[t][k] = indices[3 * size_t{centroids[t].triangle} + k];
    move(positions);
}

// Partitions the centroids at their median along the longest side of their box.
void TriangleIndex::halve(std::span<Centroid> centroids) {
    Vec3<float> low = centroids[0].place, high = low;
    for (const Centroid& one : centroids) {
        low = {std::min(low.x, one.place.x), std::min(low.y, one.place.y), std::min(low.z, one.place.z)};
        high = {std::max(high.x, one.place.x), std::max(high.y, one.place.y), std::max(high.z, one.place.z)};
    }
    const Vec3<float> extent = high - low;
    float Vec3<float>::*axis = &Vec3<float>::x;
    for (float Vec3<float>::*other : {&Vec3<float>::y, &Vec3<float>::z})
        if (extent.*other > extent.*axis) axis = other;
    const auto half = static_cast<std::ptrdiff_t>(centroids.size() / 2);
    std::ranges::nth_element(centroids, centroids.begin() + half, [axis](const Centroid& a, const Centroid& b) {
        return a.place.*axis != b.place.*axis ? a.place.*axis < b.place.*axis : a.triangle < b.triangle;
    });
}

// Splits the triangles into up to four parts by halving them twice, and each part again until it fits into a leaf. The
// root is always a node.
TriangleIndex::Part TriangleIndex::add_part(std::span<Centroid> centroids, uint32_t first, uint32_t parent,
                                            uint32_t lane) {
    const uint32_t at = count_of(nodes_);
    if (at > 0 && centroids.size() <= kLanes) {
        std::fill_n(leaf_of_.begin() + first, centroids.size(), count_of(leaves_));
        leaves_.push_back({.first_triangle = first, .triangle_count = count_of(centroids), .parent = parent});
        return kLeaf | (count_of(leaves_) - 1);
    }
    nodes_.push_back({.parent = parent, .lane = lane});
    const auto divide = [&](auto& self, std::span<Centroid> some, uint32_t from, int halvings) -> void {
        if (halvings == 0 || some.size() <= kLanes) {
            const uint32_t part = nodes_[at].part_count++;
            const Part added = add_part(some, from, at, part);
            nodes_[at].parts[part] = added;
            return;
        }
        halve(some);
        const size_t half = some.size() / 2;
        self(self, some.first(half), from, halvings - 1);
        self(self, some.subspan(half), from + static_cast<uint32_t>(half), halvings - 1);
    };
    divide(divide, centroids, first, 2);
    return at;
}

TriangleIndex::Box TriangleIndex::box_of(Part part) const {
    Four3 low, high;
    if ((part & kLeaf) != 0) {
        const Leaf& leaf = leaves_[part & ~kLeaf];
        low = lower(lower(leaf.a, leaf.b), leaf.c), high = higher(higher(leaf.a, leaf.b), leaf.c);
    } else
        low = nodes_[part].low, high = nodes_[part].high;
    return {{smallest(low.x), smallest(low.y), smallest(low.z)}, {largest(high.x), largest(high.y), largest(high.z)}};
}

void TriangleIndex::move(std::span<const Vec3<float>> positions) {
    for (Leaf& leaf : leaves_) {
        for (uint32_t lane = 0; lane < kLanes; ++lane) {
            const auto& [a, b, c] = corners_[leaf.first_triangle + std::min(lane, leaf.triangle_count - 1)];
            leaf.a.set(lane, positions[a]), leaf.b.set(lane, positions[b]), leaf.c.set(lane, positions[c]);
        }
    }
    for (size_t at = nodes_.size(); at-- > 0;) {
        Node& node = nodes_[at];
        node.low = four(Vec3<float>{kNowhere, kNowhere, kNowhere});
        node.high = four(Vec3<float>{-kNowhere, -kNowhere, -kNowhere});
        for (uint32_t lane = 0; lane < node.part_count; ++lane) {
            const Box box = box_of(node.parts[lane]);
            node.low.set(lane, box.low), node.high.set(lane, box.high);
        }
    }
}

void TriangleIndex::look_at(const Leaf& leaf, const Four3& p, Nearest& best) const {
    ++best.steps;
    const Four distances = squared_distances(p, leaf.a, leaf.b, leaf.c);
    if (!is_any(distances < best.squared_distance)) return;
    for (uint32_t lane = 0; lane < leaf.triangle_count; ++lane)
        if (distances[lane] < best.squared_distance)
            best.squared_distance = distances[lane], best.triangle = leaf.first_triangle + lane;
}

// Searches all parts below `top` except one, the nearest first.
void TriangleIndex::search_below(uint32_t top, Part except, const Four3& p, float enough, Nearest& best) const {
    struct Waiting {
        Part part;
        float squared_distance;
    };
    std::array<Waiting, kDeepest> waiting;
    waiting[0] = {top, 0};
    for (size_t count = 1; count > 0 && best.squared_distance > enough;) {
        const Waiting next = waiting[--count];
        if (!(next.squared_distance < best.squared_distance)) continue;
        if ((next.part & kLeaf) != 0) {
            look_at(leaves_[next.part & ~kLeaf], p, best);
            continue;
        }
        ++best.steps;
        const Node& node = nodes_[next.part];
        const Four distances = squared_distance_from_box(p, node.low, node.high);
        if (!is_any(distances < best.squared_distance)) continue;
        const size_t nearest_at = count;
        for (uint32_t lane = 0; lane < node.part_count; ++lane) {
            const Waiting part{node.parts[lane], distances[lane]};
            if (part.part == except || !(part.squared_distance < best.squared_distance)) continue;
            size_t at = count++;
            for (; at > nearest_at && waiting[at - 1].squared_distance < part.squared_distance; --at)
                waiting[at] = waiting[at - 1];
            waiting[at] = part;
        }
    }
}

TriangleIndex::Nearest TriangleIndex::nearest(const Vec3<float>& place, float enough, uint32_t guess) const {
    Nearest best;
    if (leaves_.empty()) return best;
    const Four3 p = four(place);
    const Leaf& leaf = leaves_[leaf_of_[guess]];
    look_at(leaf, p, best);
    // Begins with the smallest node around the guess whose box is within `enough`. Then goes up to the root, and
    // searches what it has not searched yet.
    const auto is_far = [&](const Node& node) {
        const Node& parent = nodes_[node.parent];
        return squared_distance_from_box(p, parent.low, parent.high)[node.lane] > enough;
    };
    uint32_t at = leaf.parent;
    for (; at != 0 && is_far(nodes_[at]) && best.squared_distance > enough; ++best.steps) at = nodes_[at].parent;
    for (Part done = kLeaf | leaf_of_[guess]; best.squared_distance > enough; at = nodes_[at].parent) {
        search_below(at, done, p, enough, best);
        if (at == 0) break;
        done = at;
    }
    return best;
}

}  // namespace throng
