#include "tools/view/pick.h"

#include <algorithm>
#include <array>
#include <limits>

namespace throng::view {
namespace {

// The inverse's linear part times `v`, by Cramer's rule.
Vec3<float> undo(const Affine& m, float determinant_of_m, const Vec3<float>& v) {
    const auto column = [&](size_t c) { return Vec3<float>{m.row[0][c], m.row[1][c], m.row[2][c]}; };
    const Vec3<float> a = column(0), b = column(1), c = column(2);
    return Vec3<float>{dot(v, cross(b, c)), dot(v, cross(c, a)), dot(v, cross(a, b))} * (1 / determinant_of_m);
}

}  // namespace

std::optional<float> distance_to(const PlacedBox& box, const Projection::Ray& ray) {
    const Affine& m = box.world_from_model;
    const float volume = determinant(m);
    if (volume == 0) return std::nullopt;
    const Vec3<float> origin = undo(m, volume, ray.origin - Vec3<float>{m.row[0][3], m.row[1][3], m.row[2][3]}),
                      direction = undo(m, volume, ray.direction);

    // Slabs: Kay and Kajiya, "Ray tracing complex scenes", 1986.
    float enter = 0, leave = std::numeric_limits<float>::infinity();
    const auto clip = [&](float from, float along, float low, float high) {
        if (along == 0) {
            if (from < low || from > high) leave = -1;
            return;
        }
        const auto [first, second] = std::minmax({(low - from) / along, (high - from) / along});
        enter = std::max(enter, first);
        leave = std::min(leave, second);
    };
    clip(origin.x, direction.x, box.min.x, box.max.x);
    clip(origin.y, direction.y, box.min.y, box.max.y);
    clip(origin.z, direction.z, box.min.z, box.max.z);
    if (!(enter <= leave)) return std::nullopt;
    return enter;
}

}  // namespace throng::view
