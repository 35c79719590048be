// Interpolates a triangle's attributes at a point of the picture or of the shadow map.
#pragma once

#include "raster/frame.h"
#include "raster/lane_vectors.h"

namespace throng::raster {
namespace {

struct ClipPoint {
    Real x, y, w;
};

// How the weights of the corners change from a pixel to the next one on the right, or below.
struct Steps {
    Real of[3];
    template <class T>
    INLINE T sum(const T (&corners)[3]) const {
        return corners[0] * of[0] + corners[1] * of[1] + corners[2] * of[2];
    }
};

// Perspective-correct weights of the corners, from the edges' 2D homogeneous coordinates, which need no clipping
// (M. Olano and T. Greer, Triangle Scan Conversion Using 2D Homogeneous Coordinates, Graphics Hardware 1997).
class Interpolation {
public:
    // x, y: the point, in the space of the corners; -1..1 in the picture.
    INLINE Interpolation(const ClipPoint (&corners)[3], Real x, Real y) {
        for (int k = 0; k < 3; ++k)
            corners_[k] = {corners[k].x - x * corners[k].w, corners[k].y - y * corners[k].w, corners[k].w};
        Real edges[3];
        for (int k = 0; k < 3; ++k) {
            const ClipPoint &a = corners_[(k + 1) % 3], &b = corners_[(k + 2) % 3];
            edges[k] = a.x * b.y - b.x * a.y;
        }
        area_ = edges[0] + edges[1] + edges[2];
        // A triangle without area is shaded as its first corner
        const Mask has_area = abs(area_) > 1e-30f;
        per_area_ = inverse(choose(has_area, area_, 1));
        for (int k = 0; k < 3; ++k) weights_[k] = choose(has_area, edges[k] * per_area_, k == 0 ? 1.0f : 0.0f);
    }

    INLINE Real area() const { return area_; }  // below 0: counter-clockwise, y downward

    template <class T>
    INLINE T at(const T (&corners)[3]) const {
        return corners[0] * weights_[0] + corners[1] * weights_[1] + corners[2] * weights_[2];
    }
    // Steps of `by` to the right, and down.
    INLINE Steps step_x(float by) const {
        return steps([by](const ClipPoint& a, const ClipPoint& b) { return (b.w * a.y - a.w * b.y) * by; });
    }
    INLINE Steps step_y(float by) const {
        return steps([by](const ClipPoint& a, const ClipPoint& b) { return (a.w * b.x - b.w * a.x) * by; });
    }

private:
    template <class EdgeStep>
    INLINE Steps steps(const EdgeStep& edge_step) const {
        Real edges[3];
        for (int k = 0; k < 3; ++k) edges[k] = edge_step(corners_[(k + 1) % 3], corners_[(k + 2) % 3]);
        const Real area = edges[0] + edges[1] + edges[2];
        Steps steps;
        for (int k = 0; k < 3; ++k) steps.of[k] = (edges[k] - weights_[k] * area) * per_area_;
        return steps;
    }

    ClipPoint corners_[3];  // relative to the point
    Real weights_[3];
    Real area_, per_area_;
};

// A row of a matrix times a place.
INLINE Real clip_row(const float (&row)[4], const vec3& place) {
    return row[0] * place.x + (row[1] * place.y + (row[2] * place.z + row[3]));
}
INLINE ClipPoint to_picture(const Scene& scene, const vec3& world) {
    const auto& rows = scene.clip_from_world;
    return {clip_row(rows[0], world), clip_row(rows[1], world), clip_row(rows[3], world)};
}
INLINE ClipPoint to_map(const Scene& scene, const vec3& world) {
    return {clip_row(scene.map_from_world[0], world), clip_row(scene.map_from_world[1], world), 1};
}

INLINE vec4 unpacked_color(Whole color) {
    return vec4(Real(color & 255), Real((color >> 8) & 255), Real((color >> 16) & 255), Real((color >> 24) & 255)) *
           (1 / 255.0f);
}

}  // namespace
}  // namespace throng::raster
