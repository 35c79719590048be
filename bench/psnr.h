// How alike two pictures are.
#pragma once

#include <throng/draw.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

namespace throng::bench {

// Peak signal-to-noise ratio over red, green and blue, in dB: infinite if the pictures are the same, 0 if their sizes
// differ. The `left_out_pixels` pixels that differ most do not count.
inline double psnr(const Picture& a, const Picture& b, size_t left_out_pixels = 0) {
    if (a.rgba.size() != b.rgba.size() || a.width != b.width) return 0;
    std::vector<double> squares(a.rgba.size() / 4);
    for (size_t i = 0; i < a.rgba.size(); ++i) {
        const double difference = double(a.rgba[i]) - double(b.rgba[i]);
        if (i % 4 != 3) squares[i / 4] += difference * difference;
    }
    const size_t count = squares.size() - std::min(left_out_pixels, squares.size());
    std::ranges::nth_element(squares, squares.begin() + static_cast<std::ptrdiff_t>(count));
    const double sum = std::accumulate(squares.begin(), squares.begin() + static_cast<std::ptrdiff_t>(count), 0.0);
    if (sum == 0) return std::numeric_limits<double>::infinity();
    return 10 * std::log10(255 * 255 * 3 * static_cast<double>(count) / sum);
}

// The least psnr() that two renderers' pictures must have if one of them places vertices with this number of sub-pixel
// bits. With 8, as most devices and throng's own renderer have, 45 dB is a difference of 1.4 of 255 in every pixel, or
// of 20 in 0.5 % of them; with SwiftShader's 4 the edges of all triangles move a little.
constexpr double min_alike_db(uint32_t sub_pixel_bits) { return sub_pixel_bits >= 8 ? 45 : 33; }

}  // namespace throng::bench
