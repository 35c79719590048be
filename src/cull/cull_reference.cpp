#include "cull/cull_reference.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace throng {
namespace {

Vec3<double> xyz(const io::vec4& v) { return {v.x, v.y, v.z}; }

Vec3<double> column(const AffineT<double>& m, size_t k) { return {m.row[0][k], m.row[1][k], m.row[2][k]}; }

}  // namespace

double seen_by(const io::CullView& view, const AffineT<double>& world_from_model, const CullBox& box) {
    double least = std::numeric_limits<double>::infinity();
    for (const io::vec4& plane : view.planes) {
        const Vec3<double> normal = xyz(plane);
        double reach = dot(normal, transform_point(world_from_model, box.centre)) + plane.w + std::max(dot(normal, xyz(view.shadow)), 0.0);
        reach += std::abs(dot(normal, column(world_from_model, 0))) * box.half_extent.x + std::abs(dot(normal, column(world_from_model, 1))) * box.half_extent.y +
                 std::abs(dot(normal, column(world_from_model, 2))) * box.half_extent.z;
        least = std::min(least, reach);
    }
    return least;
}

double spare_of_detail(const io::CullView& view, const AffineT<double>& world_from_model, const CullBox& box, double detail_error) {
    const double scale = std::max({length(column(world_from_model, 0)), length(column(world_from_model, 1)), length(column(world_from_model, 2))});
    const double distance = length(transform_point(world_from_model, box.centre) - xyz(view.eye)) - scale * length(box.half_extent);
    return distance - detail_error * scale * view.eye.w;
}

}  // namespace throng
