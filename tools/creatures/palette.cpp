#include "tools/creatures/palette.h"

namespace throng::creature {
namespace {

Vec srgb_to_linear(const Vec& c) {
    // Cubic fit by C. Tavares, "sRGB approximations for HLSL", 2012; 0.002 off at most.
    const auto one = [](double v) { return v * (v * (v * 0.305306011 + 0.682171111) + 0.012522878); };
    return {one(c.x), one(c.y), one(c.z)};
}

}  // namespace

Vec color_of(double hue, double saturation, double value) {
    const auto channel = [&](double offset) {
        const double h = (hue + offset - std::floor(hue + offset)) * 6;
        const double distance = h < 3 ? h : 6 - h;
        return value * mix(1 - saturation, 1, std::clamp(2 - distance, 0.0, 1.0));
    };
    return srgb_to_linear({channel(0), channel(2.0 / 3), channel(1.0 / 3)});
}

Paint plain(const Vec& color) {
    return [=](double, double) { return color; };
}
Paint fading(const Vec& start, const Vec& end) {
    return [=](double t, double) { return lerp(start, end, t); };
}
Paint changing(const Vec& start, std::vector<Change> changes) {
    return [=](double t, double) {
        Vec color = start;
        for (const Change& change : changes) color = lerp(color, change.color, smooth_step(change.from, change.to, t));
        return color;
    };
}

}  // namespace throng::creature
