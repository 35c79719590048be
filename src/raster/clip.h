// Triangles that reach nearer than the near plane, or too far outside of the picture: clipped to polygons.
#pragma once

#include "raster/fill.h"
#include "raster/project.h"

namespace throng::raster {
namespace {

// Clip coordinates without z, which in the picture is the near distance everywhere.
struct ClipVertex {
    double x, y, w;
    double height;  // in a map
    // The screen position that the vertex has in triangles that are not clipped; kFarAway if it has none
    float screen_x = kFarAway, screen_y = kFarAway;
};

// Each of the five planes adds at most one corner. If rounding makes the polygon concave, because coordinates are very
// far apart, there could be more; add() drops those.
struct ClipPolygon {
    static constexpr uint32_t kMaximum = 3 + 5;
    ClipVertex of[kMaximum];
    uint32_t count = 0;
    INLINE void add(const ClipVertex& v) {
        if (count < kMaximum) of[count++] = v;
    }
};

template <class Distance>
void clip(ClipPolygon& polygon, const Distance& distance) {
    ClipPolygon inside;
    for (uint32_t i = 0; i < polygon.count; ++i) {
        const ClipVertex &a = polygon.of[i], &b = polygon.of[(i + 1) % polygon.count];
        const double from = distance(a), to = distance(b);
        if (from >= 0) inside.add(a);
        if ((from >= 0) == (to >= 0)) continue;
        // Always interpolates from the inner end, whichever way the edge is walked, so that neighbours meet exactly
        const bool turns = from < 0;
        const ClipVertex &p = turns ? b : a, &q = turns ? a : b;
        const double part = (turns ? to : from) / ((turns ? to : from) - (turns ? from : to));
        const auto between = [part](double s, double t) { return s + part * (t - s); };
        inside.add({between(p.x, q.x), between(p.y, q.y), between(p.w, q.w), between(p.height, q.height)});
    }
    polygon = inside;
}

// Subpixels as an integer, clamped to the guard band; NaN gives its lower end.
INLINE int32_t guarded(double subpixels) {
    constexpr double kMaximum = double{kGuard};
    return static_cast<int32_t>(subpixels > kMaximum ? kMaximum : subpixels >= -kMaximum ? subpixels : -kMaximum);
}

// Calls draw(ScreenTriangle) for each triangle of the clipped polygon; never if a corner is not finite.
template <Into kInto, class Draw>
void clip_triangle(const Frame& frame, const ClipVertex (&corners)[3], const Draw& draw) {
    const double half_width = (kInto == Into::kMap ? frame.map_size : frame.width) * 128.0,
                 half_height = (kInto == Into::kMap ? frame.map_size : frame.height) * 128.0;
    const double near = kInto == Into::kMap ? 0.0 : double{frame.scene.clip_from_world[2][3]};
    ClipPolygon polygon;
    for (const ClipVertex& corner : corners) {
        if (!__builtin_isfinite(corner.x + corner.y + corner.w + corner.height)) return;
        polygon.add(corner);
    }
    if constexpr (kInto != Into::kMap) clip(polygon, [near](const ClipVertex& v) { return v.w - near; });
    // Clips to half the guard band, so that rounded coordinates stay within it.
    const double right = 0.5 * double{kGuard} / half_width - 1, bottom = 0.5 * double{kGuard} / half_height - 1;
    clip(polygon, [right](const ClipVertex& v) { return right * v.w - v.x; });
    clip(polygon, [right](const ClipVertex& v) { return right * v.w + v.x; });
    clip(polygon, [bottom](const ClipVertex& v) { return bottom * v.w - v.y; });
    clip(polygon, [bottom](const ClipVertex& v) { return bottom * v.w + v.y; });
    if (polygon.count < 3) return;

    int32_t x[ClipPolygon::kMaximum], y[ClipPolygon::kMaximum];
    float z[ClipPolygon::kMaximum];
    for (uint32_t i = 0; i < polygon.count; ++i) {
        const ClipVertex& v = polygon.of[i];
        const bool is_whole = v.screen_x < kFarAway && v.screen_y < kFarAway;
        x[i] = guarded(is_whole ? double{v.screen_x} : __builtin_rint((v.x / v.w + 1) * half_width));
        y[i] = guarded(is_whole ? double{v.screen_y} : __builtin_rint((v.y / v.w + 1) * half_height));
        z[i] = static_cast<float>(kInto == Into::kMap ? v.height : near / v.w);
    }
    for (uint32_t i = 2; i < polygon.count; ++i)
        draw(ScreenTriangle{{x[0], x[i - 1], x[i]}, {y[0], y[i - 1], y[i]}, {z[0], z[i - 1], z[i]}});
}

}  // namespace
}  // namespace throng::raster
