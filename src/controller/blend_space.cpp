#include "controller/blend_space.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>

namespace throng {
namespace {

struct Place {
    double x, y;
};

using Triangle = std::array<uint32_t, 3>;  // counterclockwise
using Edge = std::array<uint32_t, 2>;

constexpr double kFlat = 1e-4;         // height relative to length
constexpr double kCocircular = 1e-12;  // for coordinates within 0..2; many times the rounding error

double cross(Place a, Place b, Place c) { return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x); }
double squared_distance(Place a, Place b) { return (b.x - a.x) * (b.x - a.x) + (b.y - a.y) * (b.y - a.y); }

// Whether d lies within the circle through a, b, c (Guibas and Stolfi, ACM Transactions on Graphics 4, 1985).
bool in_circle(Place a, Place b, Place c, Place d) {
    const auto lifted = [&](Place p, Place q, Place r) { return squared_distance(d, p) * cross(d, q, r); };
    return lifted(a, b, c) + lifted(b, c, a) + lifted(c, a, b) > kCocircular;
}

// The points moved to the origin, and x and y scaled by powers of two, which rounds nothing: points on a line stay
// exactly on a line, and the corners of an upright rectangle on a circle.
std::vector<Place> scaled(std::span<const BlendPoint> points) {
    const auto [left, right] = std::ranges::minmax(points, {}, &BlendPoint::x);
    const auto [bottom, top] = std::ranges::minmax(points, {}, &BlendPoint::y);
    const auto scale = [](double range, double value) {
        return range > 0 ? std::ldexp(value, -std::ilogb(range)) : 0.0;
    };
    const double x = left.x, y = bottom.y, width = right.x - x, height = top.y - y;
    std::vector<Place> places;
    for (const BlendPoint& point : points) places.push_back({scale(width, point.x - x), scale(height, point.y - y)});
    return places;
}

// The edges of points that all lie on a line, or nearly so; nothing otherwise.
std::optional<std::vector<Edge>> edges_of_line(std::span<const Place> places) {
    const Place first = places[0];
    const Place end = *std::ranges::max_element(places, {}, [&](Place p) { return squared_distance(first, p); });
    const double flat = kFlat * squared_distance(first, end);
    if (std::ranges::any_of(places, [&](Place p) { return std::abs(cross(first, end, p)) > flat; }))
        return std::nullopt;
    std::vector<uint32_t> order(places.size());
    std::iota(order.begin(), order.end(), 0u);
    std::ranges::sort(order, {}, [&](uint32_t i) {
        return (places[i].x - first.x) * (end.x - first.x) + (places[i].y - first.y) * (end.y - first.y);
    });
    std::vector<Edge> edges;
    for (size_t i = 0; i + 1 < order.size(); ++i) edges.push_back({order[i], order[i + 1]});
    if (edges.empty()) edges.push_back({0, 0});
    return edges;
}

class Triangulation {
public:
    explicit Triangulation(std::span<const Place> places) : places_(places) {
        sweep();
        while (flip_one()) {}
        find_border();
        while (peel_one()) {}
    }

    std::vector<Triangle> triangles;
    std::vector<Edge> border;

private:
    double area(uint32_t a, uint32_t b, uint32_t c) const { return cross(places_[a], places_[b], places_[c]); }

    // Any triangulation: from left to right, each point is joined to all sides of the hull that it sees.
    void sweep() {
        std::vector<uint32_t> order(places_.size());
        std::iota(order.begin(), order.end(), 0u);
        std::ranges::sort(order, [&](uint32_t i, uint32_t k) {
            return std::pair(places_[i].x, places_[i].y) < std::pair(places_[k].x, places_[k].y);
        });
        const auto apex = std::ranges::find_if(order, [&](uint32_t i) { return area(order[0], order[1], i) != 0; });
        // The points before the apex lie on a line. They form a hull without an inside, ordered so that the apex is on
        // its right
        std::vector<uint32_t> hull(order.begin(), apex);
        if (area(order[0], order[1], *apex) > 0) std::ranges::reverse(hull);
        for (size_t i = 0; i + 1 < hull.size(); ++i) triangles.push_back({hull[i + 1], hull[i], *apex});
        std::ranges::reverse(hull);
        hull.push_back(*apex);
        for (auto next = apex + 1; next != order.end(); ++next) join(hull, *next);
    }

    void join(std::vector<uint32_t>& hull, uint32_t point) {
        const auto sees = [&](size_t i) { return area(hull[i], hull[(i + 1) % hull.size()], point) < 0; };
        size_t first = 0;
        while (first < hull.size() && !(sees(first) && !sees((first + hull.size() - 1) % hull.size()))) ++first;
        if (first == hull.size()) return;
        std::ranges::rotate(hull, hull.begin() + static_cast<std::ptrdiff_t>(first));
        size_t count = 0;
        for (; sees(count); ++count) triangles.push_back({hull[count + 1], hull[count], point});
        hull.erase(hull.begin() + 1, hull.begin() + static_cast<std::ptrdiff_t>(count));
        hull.insert(hull.begin() + 1, point);
    }

    // If the far point of a neighbour lies in a triangle's circumcircle, flips their common edge (Lawson 1977). This
    // ends when no circumcircle contains a point.
    bool flip_one() {
        for (Triangle& one : triangles)
            for (size_t side = 0; side < 3; ++side) {
                const uint32_t a = one[side], b = one[(side + 1) % 3], c = one[(side + 2) % 3];
                for (Triangle& other : triangles) {
                    const std::optional<uint32_t> d = apex_over(other, b, a);
                    if (!d || !in_circle(places_[a], places_[b], places_[c], places_[*d]) || area(c, a, *d) <= 0 ||
                        area(*d, b, c) <= 0)
                        continue;
                    one = {c, a, *d};
                    other = {*d, b, c};
                    return true;
                }
            }
        return false;
    }

    static std::optional<uint32_t> apex_over(const Triangle& triangle, uint32_t from, uint32_t to) {
        for (size_t side = 0; side < 3; ++side)
            if (triangle[side] == from && triangle[(side + 1) % 3] == to) return triangle[(side + 2) % 3];
        return std::nullopt;
    }

    void find_border() {
        for (const Triangle& triangle : triangles)
            for (size_t side = 0; side < 3; ++side) {
                const Edge edge{triangle[side], triangle[(side + 1) % 3]};
                if (std::ranges::none_of(triangles, [&](const Triangle& other) {
                        return apex_over(other, edge[1], edge[0]).has_value();
                    }))
                    border.push_back(edge);
            }
    }

    // Removes a nearly flat triangle whose long side is on the border. Its two short sides become the border there.
    bool peel_one() {
        for (auto triangle = triangles.begin(); triangle != triangles.end(); ++triangle)
            for (size_t side = 0; side < 3; ++side) {
                const uint32_t a = (*triangle)[side], b = (*triangle)[(side + 1) % 3], c = (*triangle)[(side + 2) % 3];
                const auto at = std::ranges::find(border, Edge{a, b});
                if (at == border.end() || area(a, b, c) > kFlat * squared_distance(places_[a], places_[b])) continue;
                border.erase(at);
                for (const Edge& edge : {Edge{b, c}, Edge{c, a}})
                    if (std::ranges::find(border, edge) == border.end()) border.push_back({edge[1], edge[0]});
                triangles.erase(triangle);
                return true;
            }
        return false;
    }

    std::span<const Place> places_;
};

io::ControlTriangle weights_within(std::span<const BlendPoint> points, const Triangle& triangle) {
    const auto place = [&](uint32_t i) { return Place{points[i].x, points[i].y}; };
    const Place a = place(triangle[0]), b = place(triangle[1]), c = place(triangle[2]);
    const double area = cross(a, b, c);
    const auto part = [&](double value) { return static_cast<float>(value / area); };
    return {triangle[0],     triangle[1],     triangle[2],
            part(b.y - c.y), part(c.x - b.x), part(b.x * c.y - c.x * b.y),
            part(c.y - a.y), part(a.x - c.x), part(c.x * a.y - a.x * c.y)};
}

io::ControlEdge weights_along(std::span<const BlendPoint> points, const Edge& edge) {
    const BlendPoint &a = points[edge[0]], &b = points[edge[1]];
    const double dx = double{b.x} - a.x, dy = double{b.y} - a.y, squared = dx * dx + dy * dy;
    if (squared == 0) return {edge[0], edge[1], 0, 0};
    return {edge[0], edge[1], static_cast<float>(dx / squared), static_cast<float>(dy / squared)};
}

}  // namespace

BlendSpace make_blend_space(std::span<const BlendPoint> points) {
    const std::vector<Place> places = scaled(points);
    BlendSpace space;
    const auto add_edges = [&](std::span<const Edge> edges) {
        for (const Edge& edge : edges) space.edges.push_back(weights_along(points, edge));
    };
    if (const auto line = edges_of_line(places)) {
        add_edges(*line);
        return space;
    }
    const Triangulation triangulation(places);
    for (const Triangle& triangle : triangulation.triangles)
        space.triangles.push_back(weights_within(points, triangle));
    add_edges(triangulation.border);
    return space;
}

}  // namespace throng
