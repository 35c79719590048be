#include "creature_palette.h"

namespace throng::creature {
namespace {

Vec srgb_to_linear(const Vec& c) {
    // Cubic fit by C. Tavares, "sRGB approximations for HLSL", 2012; 0.002 off at most.
    const auto one = [](double v) { return v * (v * (v * 0.305306011 + 0.682171111) + 0.012522878); };
    return {one(c.x), one(c.y), one(c.z)};
}
// Hue in turns from red over green and blue.
Vec color_of(double hue, double saturation, double value) {
    const auto channel = [&](double offset) {
        const double h = (hue + offset - std::floor(hue + offset)) * 6;
        const double distance = h < 3 ? h : 6 - h;
        return value * mix(1 - saturation, 1, std::clamp(2 - distance, 0.0, 1.0));
    };
    return srgb_to_linear({channel(0), channel(2.0 / 3), channel(1.0 / 3)});
}

}  // namespace

Palette::Palette(uint64_t seed) {
    Random random(~seed);
    const double hue = random.unit();
    const double tip = hue + random.between(0.38, 0.62);
    back_ = color_of(hue, 0.72, 0.42);
    stripe_ = color_of(hue - 0.04, 0.8, 0.25);
    flank_ = color_of(hue + 0.02, 0.68, 0.66);
    belly_ = color_of(hue + 0.11, 0.34, 0.93);
    accent_ = color_of(tip, 0.66, 0.90);
    membrane_ = color_of(tip + 0.05, 0.55, 0.72);
    horn_ = color_of(0.11, 0.22, 0.9);
    eye_ = color_of(0.13, 0.85, 1.0);
}

Vec Palette::at(Paint paint, double t, double dorsal) const {
    switch (paint) {
        case Paint::kBody: {
            const double stripes =
                smooth_step(0.1, 0.9, sine(t * 19)) * smooth_step(0.2, 0.8, dorsal) * smooth_step(0.24, 0.3, t);
            Vec c = lerp(belly_, flank_, smooth_step(-0.75, -0.1, dorsal));
            c = lerp(c, back_, smooth_step(-0.1, 0.8, dorsal));
            c = lerp(c, stripe_, 0.7 * stripes);
            return lerp(c, accent_, 0.9 * smooth_step(0.8, 1.0, t));
        }
        case Paint::kJaw: return lerp(flank_, belly_, smooth_step(0.2, -0.6, dorsal));
        case Paint::kLeg: return lerp(lerp(flank_, back_, smooth_step(0, 0.5, t)), stripe_, smooth_step(0.5, 1, t));
        case Paint::kWing:
            return lerp(lerp(back_, membrane_, smooth_step(0, 0.35, t)), accent_, smooth_step(0.7, 1, t));
        case Paint::kFinger: return lerp(back_, stripe_, smooth_step(0, 0.7, t));
        case Paint::kClaw: return lerp(stripe_, horn_, smooth_step(0.3, 0.8, t));
        case Paint::kHorn: return lerp(horn_ * 0.55, horn_, t);
        case Paint::kEye: return lerp(eye_, {0.01, 0.01, 0.015}, smooth_step(0.4, 0.6, t));
        case Paint::kTendril: return lerp(back_, accent_, smooth_step(0, 0.7, t));
    }
    return {1, 1, 1};
}

}  // namespace throng::creature
