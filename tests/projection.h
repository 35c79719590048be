// Projects points to where cameras see them.
#pragma once

#include <throng/draw.h>

#include <cmath>

namespace throng::test {

// Where a point falls in the picture: -1..1 across and upward where it is inside, and the distance in front of the eye.
inline Vec3<double> project(const Camera& camera, double aspect_ratio, const Vec3<double>& point) {
    const Vec3<double> eye = camera.eye.as<double>(), forward = normalized(camera.target.as<double>() - eye);
    const Vec3<double> right = normalized(cross(forward, Vec3<double>{0, 1, 0})), up = cross(right, forward),
                       p = point - eye;
    const double depth = dot(p, forward), half_height = depth * std::tan(double{camera.vertical_field_of_view_rad} / 2);
    return {dot(p, right) / (half_height * aspect_ratio), dot(p, up) / half_height, depth};
}

}  // namespace throng::test
