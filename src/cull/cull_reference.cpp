#include "cull/cull_reference.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace throng {
namespace {

Vec3<double> xyz(const io::vec4& v) { return {v.x, v.y, v.z}; }

Vec3<double> column(const AffineT<double>& m, size_t k) { return {m.row[0][k], m.row[1][k], m.row[2][k]}; }

}  // namespace

Vec3<double> shadow_of(const io::CullView& view, const AffineT<double>& world_from_model, const CullBox& box) {
    const Vec3<double> shadow = xyz(view.shadow);
    double top = -std::numeric_limits<double>::infinity();
    for (uint32_t corner = 0; corner < 8; ++corner) {
        const auto side = [&](uint32_t bit) { return (corner & bit) != 0 ? 1.0 : -1.0; };
        top = std::max(top, transform_point(world_from_model, box.centre + Vec3<double>{side(1) * box.half_extent.x,
                                                                                        side(2) * box.half_extent.y,
                                                                                        side(4) * box.half_extent.z})
                                .y);
    }
    const double fall = top - double{view.ground};
    if (fall <= 0) return {};
    return -shadow.y <= fall ? shadow : shadow * (fall / -shadow.y);
}

double seen_by(const io::CullView& view, const AffineT<double>& world_from_model, const CullBox& box) {
    const Vec3<double> shadow = shadow_of(view, world_from_model, box);
    double least = std::numeric_limits<double>::infinity();
    for (const io::vec4& plane : view.planes) {
        const Vec3<double> normal = xyz(plane);
        if (length(normal) == 0 && plane.w >= 0) continue;
        double reach = dot(normal, transform_point(world_from_model, box.centre)) + plane.w +
                       std::max(dot(normal, shadow), 0.0);
        reach += std::abs(dot(normal, column(world_from_model, 0))) * box.half_extent.x +
                 std::abs(dot(normal, column(world_from_model, 1))) * box.half_extent.y +
                 std::abs(dot(normal, column(world_from_model, 2))) * box.half_extent.z;
        least = std::min(least, reach);
    }
    return least;
}

double spare_of_lod(const io::CullView& view, const AffineT<double>& world_from_model, const CullBox& box,
                    double lod_error) {
    double scale = 0;
    for (size_t a = 0; a < 3; ++a) {
        double sum = 0;
        for (size_t b = 0; b < 3; ++b) sum += std::abs(dot(column(world_from_model, a), column(world_from_model, b)));
        scale = std::max(scale, std::sqrt(sum));
    }
    const double distance = length(transform_point(world_from_model, box.centre) - xyz(view.eye)) -
                            scale * length(box.half_extent);
    return distance - lod_error * scale * view.eye.w;
}

}  // namespace throng
