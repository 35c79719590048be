// Which samples of a picture a triangle covers, by Vulkan's rules, computed with integers.
#pragma once

#include "tests/host/raster_frame.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

namespace throng::test {

using ScreenTriangle = std::array<ScreenVertex, 3>;

inline constexpr int kPictureSize = RasterFrame::kSize;

struct Sample {
    int x, y;  // subpixels
};
// Vulkan's standard sample locations, for one and four samples.
inline Sample sample_at(size_t index, uint32_t sample_count) {
    static constexpr Sample kFour[4]{{96, 32}, {224, 96}, {32, 160}, {160, 224}};
    const auto pixel = static_cast<int>(index / sample_count);
    const Sample in_pixel = sample_count == 1 ? Sample{128, 128} : kFour[index % sample_count];
    return {pixel % kPictureSize * 256 + in_pixel.x, pixel / kPictureSize * 256 + in_pixel.y};
}

inline int64_t cross_of(const ScreenVertex& a, const ScreenVertex& b, const Sample& p) {
    return int64_t{b.x - a.x} * (p.y - a.y) - int64_t{b.y - a.y} * (p.x - a.x);
}

// The samples that a triangle covers: by the top-left rule, for either winding.
class Coverage {
public:
    explicit Coverage(ScreenTriangle t) {
        if (cross_of(t[0], t[1], {t[2].x, t[2].y}) < 0) std::swap(t[1], t[2]);  // clockwise, y down
        if (cross_of(t[0], t[1], {t[2].x, t[2].y}) == 0) return;                // and the box stays empty
        low_ = {std::min({t[0].x, t[1].x, t[2].x}), std::min({t[0].y, t[1].y, t[2].y})};
        high_ = {std::max({t[0].x, t[1].x, t[2].x}), std::max({t[0].y, t[1].y, t[2].y})};
        for (size_t i = 0; i < 3; ++i) {
            const ScreenVertex &a = t[i], &b = t[(i + 1) % 3];
            const bool is_top = a.y == b.y && b.x > a.x, is_left = b.y < a.y;
            edges_[i] = {a, b, is_top || is_left ? 0 : 1};
        }
    }
    bool has(const Sample& p) const {
        if (p.x < low_.x || p.x > high_.x || p.y < low_.y || p.y > high_.y) return false;
        for (const Edge& edge : edges_)
            if (cross_of(edge.a, edge.b, p) < edge.least) return false;
        return true;
    }
    // Calls visit(index, place) for each covered sample of the picture. Tests only the triangle's bounding box.
    template <class Visit>
    void visit_samples(uint32_t sample_count, const Visit& visit) const {
        const auto pixel_of = [](int subpixel) {
            return static_cast<size_t>(std::clamp(subpixel >> 8, 0, kPictureSize - 1));
        };
        for (size_t y = pixel_of(low_.y); y <= pixel_of(high_.y); ++y)
            for (size_t x = pixel_of(low_.x); x <= pixel_of(high_.x); ++x)
                for (size_t index = (y * kPictureSize + x) * sample_count, end = index + sample_count; index < end;
                     ++index)
                    if (const Sample at = sample_at(index, sample_count); has(at)) visit(index, at);
    }

private:
    struct Edge {
        ScreenVertex a, b;
        int64_t least;  // the smallest cross product of a covered sample
    };
    Sample low_{1, 1}, high_{0, 0};
    std::array<Edge, 3> edges_{};
};

// Some are smaller than a pixel, others reach beyond the picture.
inline ScreenTriangle random_triangle(Random& random, int largest) {
    const double size = 256 * std::exp(random.between(std::log(0.2), std::log(largest)));
    const double x = random.between(-20, kPictureSize + 20) * 256, y = random.between(-20, kPictureSize + 20) * 256;
    ScreenTriangle t;
    for (ScreenVertex& v : t)
        v = {static_cast<int32_t>(std::lround(x + random.between(-size, size))),
             static_cast<int32_t>(std::lround(y + random.between(-size, size))),
             static_cast<float>(1 << random.below(4))};
    return t;
}

// The last part of the name of a test that runs for each instruction set.
inline std::string isa_name(const testing::TestParamInfo<NativeIsa>& of) {
    std::string name(name_of(of.param));
    std::erase(name, '-');  // not allowed in GoogleTest's names
    return name;
}

}  // namespace throng::test
