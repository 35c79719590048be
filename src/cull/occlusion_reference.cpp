#include "cull/occlusion_reference.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace throng {

double shown_by(const io::CullView& view, const AffineT<double>& world_from_model, const CullBox& box,
                std::span<const float> depths, uint32_t width, uint32_t height) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    const Vec3<double> way = shadow_of(view, world_from_model, box);
    double left = kInfinity, right = -kInfinity, top = kInfinity, bottom = -kInfinity, nearest = -kInfinity;
    for (uint32_t corner = 0; corner < 16; ++corner) {
        const auto side = [&](uint32_t bit) { return (corner & bit) != 0 ? 1.0 : -1.0; };
        const Vec3<double> shadow = (corner & 8) != 0 ? way : Vec3<double>{};
        const Vec3<double> point = transform_point(world_from_model,
                                                   box.centre + Vec3<double>{side(1) * box.half_extent.x,
                                                                             side(2) * box.half_extent.y,
                                                                             side(4) * box.half_extent.z}) +
                                   shadow;
        const auto clip = [&](size_t row) {
            const io::vec4& r = view.clip_from_world[row];
            return r.x * point.x + r.y * point.y + r.z * point.z + double{r.w};
        };
        if (clip(3) <= 1e-6) return kInfinity;
        left = std::min(left, clip(0) / clip(3));
        right = std::max(right, clip(0) / clip(3));
        top = std::min(top, clip(1) / clip(3));
        bottom = std::max(bottom, clip(1) / clip(3));
        nearest = std::max(nearest, clip(2) / clip(3));
    }
    const auto texel = [](double at, uint32_t size) {
        return static_cast<uint32_t>(std::clamp(std::floor((at * 0.5 + 0.5) * size), 0.0, size - 1.0));
    };
    double farthest = kInfinity;
    for (uint32_t row = texel(top, height); row <= texel(bottom, height); ++row)
        for (uint32_t column = texel(left, width); column <= texel(right, width); ++column)
            farthest = std::min(farthest, double{depths[size_t{row} * width + column]});
    return nearest - farthest;
}

}  // namespace throng
