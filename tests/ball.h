// A ball on two joints, whose materials use every material feature.
#pragma once

#include <throng/asset.h>
#include <throng/draw.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace throng::test {

std::vector<std::byte> png_bytes(const Picture& picture);

// Nearly every pixel has a different colour.
Picture gradient(uint32_t width, uint32_t height);

// `pixel(x, y)` is its red, green, blue and alpha, 0..1.
template <class Pixel>
AssetImage make_image(const char* name, uint32_t width, uint32_t height, const Pixel& pixel) {
    Picture picture{width, height, {}};
    for (uint32_t y = 0; y < height; ++y)
        for (uint32_t x = 0; x < width; ++x)
            for (const double part : pixel(x, y)) picture.rgba.push_back(static_cast<uint8_t>(std::lround(255 * part)));
    return {.name = name, .encoded = png_bytes(picture)};
}

struct BallSettings {
    uint32_t columns = 24, rows = 12;
    double radius = 0.5;  // it stands on the ground
    uint32_t influence_count = 4;
    bool is_open = false;  // a quarter is missing, so that the inside shows
    bool has_morphs = false;
};

// Its clip bends it. With morphs, the clip also swells one side and turns its normals. One white material.
Asset make_ball(const BallSettings& settings = {});

// Adds all five maps, with sizes that are not powers of two, and alpha values between 0 and 1.
void add_maps(Asset& asset);

}  // namespace throng::test
