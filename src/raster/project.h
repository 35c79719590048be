// Where points of the world lie in the picture and in the shadow map.
#pragma once

#include "raster/frame.h"
#include "raster/lane_types.h"

#define INLINE_LAMBDA __attribute__((always_inline))

namespace throng::raster {
namespace {

// As on Vulkan devices, places are rounded to 1/256 of a pixel.
constexpr float kSubpixels = 256;
// The guard band: within it, coordinates and their differences (at most 2^24) are exact as floats. Triangles that reach
// beyond it are clipped first.
constexpr float kGuard = 0x1p23f;
constexpr float kFarAway = 0x1p24f;

// The index of a vertex's x in Draw::vertices.
INLINE size_t place_of(uint32_t vertex) { return size_t{vertex / kFour} * kFourFloats + vertex % kFour; }

struct ScreenPoint {
    Real x, y;   // subpixels, kFarAway if beyond the guard or nearer than the near plane
    Real depth;  // in the picture 1 at the near plane, 0 infinitely far; in the map the height towards the sun
};

INLINE Real row_times(const float (&row)[4], Real x, Real y, Real z) {
    return row[0] * x + (row[1] * y + (row[2] * z + row[3]));
}

INLINE Real snapped(Real subpixels) {
    const Real at = round(subpixels);
    return choose(abs(at) <= kGuard, at, kFarAway);
}

class ToPicture {
public:
    explicit ToPicture(const Frame& frame)
        : scene_(frame.scene),
          half_width_(static_cast<float>(frame.width) * (kSubpixels / 2)),
          half_height_(static_cast<float>(frame.height) * (kSubpixels / 2)),
          near_(frame.scene.clip_from_world[2][3]) {}

    INLINE ScreenPoint point(Real x, Real y, Real z) const {
        const auto& rows = scene_.clip_from_world;
        const Real w = row_times(rows[3], x, y, z);
        const Mask is_before_near = w < near_;
        const Real per_w = Real(1) / choose(is_before_near, near_, w);
        const Real across = (row_times(rows[0], x, y, z) * per_w + 1) * half_width_,
                   down = (row_times(rows[1], x, y, z) * per_w + 1) * half_height_;
        return {choose(is_before_near, kFarAway, snapped(across)), choose(is_before_near, kFarAway, snapped(down)),
                choose(is_before_near, 1.0f, near_ * per_w)};
    }

private:
    const Scene& scene_;
    float half_width_, half_height_;
    float near_;
};

class ToMap {
public:
    explicit ToMap(const Frame& frame) : scene_(frame.scene), size_(static_cast<float>(frame.map_size) * kSubpixels) {}

    INLINE ScreenPoint point(Real x, Real y, Real z) const {
        const auto& rows = scene_.map_from_world;
        return {snapped(row_times(rows[0], x, y, z) * size_), snapped(row_times(rows[1], x, y, z) * size_),
                row_times(rows[2], x, y, z)};
    }

private:
    const Scene& scene_;
    float size_;
};

}  // namespace
}  // namespace throng::raster
