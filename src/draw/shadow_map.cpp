#include "draw/shadow_map.h"

#include <algorithm>
#include <limits>

namespace throng {
namespace {

constexpr uint32_t kMinSize = 512, kMaxSize = 4096;  // 1 MiB and 64 MiB
constexpr double kMargin = 4;                        // texels around what is fitted, for the filter
constexpr double kGrid = 65536;                      // texels, after which map_grid repeats

struct Interval {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    void add(double value) {
        low = std::min(low, value);
        high = std::max(high, value);
    }
};

}  // namespace

ShadowFit fit_shadow(const Camera& camera, const View& view, const Bounds& posed, const Vec3<float>& to_sun,
                     uint32_t map_size) {
    // The map's axes depend only on the sun, so that what does not move keeps its place on a fixed grid of texels.
    const Vec3<double> sun = to_sun.as<double>(), eye = camera.eye.as<double>();
    const Vec3<double> across = normalized(std::abs(sun.y) > 0.9999 ? cross(sun, Vec3<double>{0, 0, 1})
                                                                    : cross(Vec3<double>{0, 1, 0}, sun));
    const std::array axes{across, cross(sun, across), sun};
    std::array<Interval, 3> of_crowd;
    double reach = 0;  // from the camera: no shadow falls farther away
    const auto low = posed.min.as<double>(), high = posed.max.as<double>();
    for (int i = 0; i < 8; ++i) {
        const Vec3<double> corner{i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z};
        for (size_t k = 0; k < 3; ++k) of_crowd[k].add(dot(axes[k], corner));
        reach = std::max(reach, length(corner - eye) + (high.y - low.y) / sun.y);
    }
    std::array<Interval, 2> seen;
    for (size_t k = 0; k < 2; ++k) {
        seen[k].add(dot(axes[k], eye));
        for (int i = 0; i < 4; ++i) {
            const Vec3<double> ray = view.forward.as<double>() +
                                     view.right.as<double>() * ((i & 1 ? 1 : -1) * double{view.half_width}) +
                                     view.up.as<double>() * ((i & 2 ? 1 : -1) * double{view.half_height});
            seen[k].add(dot(axes[k], eye + ray * reach));
        }
    }

    ShadowFit fit;
    const auto set_row = [&](size_t row, const Vec3<double>& axis, double from, double size) {
        const Vec3<double> scaled = axis * (1 / size);
        fit.map_from_world[row] = {static_cast<float>(scaled.x), static_cast<float>(scaled.y),
                                   static_cast<float>(scaled.z), static_cast<float>(-from / size)};
    };
    for (size_t k = 0; k < 2; ++k) {
        const double from = std::max(of_crowd[k].low, seen[k].low),
                     to = std::max(std::min(of_crowd[k].high, seen[k].high), from);
        const double least = std::max((to - from) / (map_size - 2 * kMargin - 1), 1e-9 * std::max(reach, 1e-20));
        // Grows in steps, so that a moving camera keeps the grid
        const double texel = std::exp2(std::ceil(4 * std::log2(least)) / 4);
        const double first = std::floor(from / texel) - kMargin;
        set_row(k, axes[k], first * texel, texel * map_size);
        fit.grid[k] = static_cast<float>(first - kGrid * std::floor(first / kGrid));
        fit.texel = std::max(fit.texel, static_cast<float>(texel));
    }
    const double height = std::max(of_crowd[2].high - of_crowd[2].low, 1e-9 * std::max(reach, 1e-20));
    set_row(2, axes[2], of_crowd[2].low - 0.1 * height, 1.2 * height);
    return fit;
}

uint32_t shadow_map_size(const VkExtent2D& picture, uint32_t samples) {
    const uint32_t larger = std::min(std::max(picture.width, picture.height), kMaxSize);
    return std::clamp(samples > 1 ? 2 * larger : larger, kMinSize, kMaxSize);
}

DepthPass make_shadow_map(const std::shared_ptr<Gpu>& gpu, const VkExtent2D& picture, uint32_t samples) {
    const uint32_t size = std::min(shadow_map_size(picture, samples), gpu->properties.limits.maxImageDimension2D);
    return {gpu, "shadow map", {size, size}, VK_SAMPLE_COUNT_1_BIT, kDepthTexture};
}

}  // namespace throng
