// The mip levels of the native renderer's textures. Sampling is tested in raster_resolve_test.
#include "raster/texture.h"

#include "tests/host/raster_cases.h"

#include <algorithm>
#include <cmath>

namespace throng {
namespace {

using Texels = std::vector<std::array<double, 4>>;  // 0..1

double linear(double part) { return part <= 0.04045 ? part / 12.92 : std::pow((part + 0.055) / 1.055, 2.4); }

// A blit to half of the size with a linear filter, as Vulkan defines it.
Texels halved(const Texels& from, int width, int height) {
    const int to_width = std::max(width / 2, 1), to_height = std::max(height / 2, 1);
    Texels to;
    for (int row = 0; row < to_height; ++row)
        for (int column = 0; column < to_width; ++column) {
            const double x = (column + 0.5) * width / to_width - 0.5, y = (row + 0.5) * height / to_height - 0.5;
            std::array<double, 4> sum{};
            for (int i = 0; i < 4; ++i) {
                const double at_x = std::floor(x) + i % 2, at_y = std::floor(y) + i / 2;
                const double weight = (1 - std::abs(x - at_x)) * (1 - std::abs(y - at_y));
                const int of = std::clamp(static_cast<int>(at_y), 0, height - 1) * width +
                               std::clamp(static_cast<int>(at_x), 0, width - 1);
                for (size_t channel = 0; channel < 4; ++channel)
                    sum[channel] += weight * from[static_cast<size_t>(of)][channel];
            }
            to.push_back(sum);
        }
    return to;
}

TEST(RasterTexture, MipsAreFilteredInLinearLight) {
    for (const auto& [width, height] : {std::pair(1, 1), {2, 2}, {8, 8}, {16, 3}, {1, 9}, {37, 21}, {64, 33}})
        for (const raster::TexelKind kind : {raster::TexelKind::kColor, raster::TexelKind::kNumbers}) {
            const Picture picture = test::noise(static_cast<uint32_t>(width), static_cast<uint32_t>(height), 7);
            const raster::OwnedTexture owned(picture, kind);
            const raster::Texture& texture = owned.texture();
            Texels expected;
            for (size_t i = 0; i < picture.rgba.size(); i += 4) {
                std::array<double, 4>& texel = expected.emplace_back();
                for (size_t channel = 0; channel < 4; ++channel) {
                    const double part = picture.rgba[i + channel] / 255.0;
                    texel[channel] = kind == raster::TexelKind::kColor && channel < 3 ? linear(part) : part;
                }
            }
            int columns = width, rows = height;
            for (uint32_t mip = 0; mip < texture.mip_count; ++mip) {
                for (size_t i = 0; i < expected.size(); ++i)
                    for (size_t channel = 0; channel < 4; ++channel)
                        ASSERT_NEAR(
                            static_cast<double>(texture.texels[texture.mip_begins[mip] + i] >> (16 * channel) & 0xFFFF),
                            65535 * expected[i][channel], 0.51 * (mip + 1))
                            << width << " x " << height << ", mip " << mip << ", texel " << i;
                expected = halved(expected, columns, rows);
                columns = std::max(columns / 2, 1);
                rows = std::max(rows / 2, 1);
            }
            EXPECT_EQ(texture.mip_count, 1 + std::floor(std::log2(std::max(width, height))));
            EXPECT_EQ(std::pair(columns, rows), std::pair(1, 1));
        }
}

}  // namespace
}  // namespace throng
