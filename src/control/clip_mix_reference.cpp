#include "control/clip_mix_reference.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace throng {
namespace {

// Triangles overlap by this part of their weights, so that rounding opens no crack between them
constexpr float kCrack = 0x1p-16f;

struct PointWeight {
    uint32_t point;  // within the state
    float weight;
};
using PointWeights = std::vector<PointWeight>;

PointWeights along(uint32_t a, uint32_t b, float t) { return {{a, 1 - t}, {b, t}}; }

PointWeights weights_on_line(std::span<const io::ControlPoint> points, float x) {
    size_t i = 0;
    while (i + 1 < points.size() && points[i + 1].x <= x) ++i;
    const float t = std::clamp((x - points[i].x) * points[i].inverse_span, 0.0f, 1.0f);
    const auto at = static_cast<uint32_t>(i);
    return i + 1 < points.size() ? along(at, at + 1, t) : PointWeights{{at, 1}};
}

std::optional<PointWeights> weights_in_triangle(const io::ControlTriangle& triangle, float x, float y) {
    const float u = (triangle.ax * x + triangle.ay * y) + triangle.a0;
    const float v = (triangle.bx * x + triangle.by * y) + triangle.b0;
    const float w = (1 - u) - v;
    if (!(u >= -kCrack && v >= -kCrack && w >= -kCrack)) return std::nullopt;
    return PointWeights{
        {triangle.a, std::max(u, 0.0f)}, {triangle.b, std::max(v, 0.0f)}, {triangle.c, std::max(w, 0.0f)}};
}

PointWeights weights_on_plane(std::span<const io::ControlPoint> points, std::span<const io::ControlTriangle> triangles,
                              std::span<const io::ControlEdge> edges, float x, float y) {
    for (const io::ControlTriangle& triangle : triangles)
        if (const auto weights = weights_in_triangle(triangle, x, y)) return *weights;
    PointWeights nearest{{0, 1}};
    float least = std::numeric_limits<float>::infinity();
    for (const io::ControlEdge& edge : edges) {
        const io::ControlPoint &a = points[edge.a], &b = points[edge.b];
        const float t = std::clamp((x - a.x) * edge.dx + (y - a.y) * edge.dy, 0.0f, 1.0f);
        const float ex = (x - a.x) - t * (b.x - a.x);
        const float ey = (y - a.y) - t * (b.y - a.y);
        const float distance = ex * ex + ey * ey;
        if (!(distance < least)) continue;
        least = distance;
        nearest = along(edge.a, edge.b, t);
    }
    return nearest;
}

template <class T>
std::span<const T> part(const std::vector<T>& all, uint32_t first, uint32_t count) {
    return std::span(all).subspan(first, count);
}

}  // namespace

const MixedClip& MixedClips::heaviest() const { return *std::ranges::max_element(clips, {}, &MixedClip::weight); }

float parameter_at(std::span<const float> parameters, uint32_t index) {
    return std::isfinite(parameters[index]) ? parameters[index] : 0;
}

MixedClips mix_of_state(const ControllerArrays& arrays, const io::ControlState& state,
                        std::span<const float> parameters) {
    const auto points = part(arrays.points, state.first_point, state.point_count);
    const auto parameter = [&](uint32_t index) { return parameter_at(parameters, index); };
    PointWeights weights{{0, 1}};
    if (state.y_parameter != io::kAbsent)
        weights = weights_on_plane(points, part(arrays.triangles, state.first_triangle, state.triangle_count),
                                   part(arrays.edges, state.first_edge, state.edge_count), parameter(state.x_parameter),
                                   parameter(state.y_parameter));
    else if (state.x_parameter != io::kAbsent)
        weights = weights_on_line(points, parameter(state.x_parameter));
    MixedClips mixed{.loop = state.loop != 0, .sync = state.sync};
    for (const PointWeight& one : weights) {
        const uint32_t clip = points[one.point].clip;
        mixed.clips.push_back({clip, one.weight});
        mixed.rate = mixed.rate + one.weight * arrays.clips[clip].rate;
    }
    mixed.rate = mixed.rate * state.speed;
    if (state.speed_parameter != io::kAbsent) mixed.rate = mixed.rate * parameter(state.speed_parameter);
    return mixed;
}

MixedClips mix_of_direct_play(const ControllerArrays& arrays, const io::LayerPlay& play) {
    return {.clips = {{play.motion, 1}}, .rate = play.speed * arrays.clips[play.motion].rate, .loop = play.loop != 0};
}

}  // namespace throng
