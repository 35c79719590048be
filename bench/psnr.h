// How alike two pictures are.
#pragma once

#include <throng/draw.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

namespace throng::bench {

// Peak signal to noise ratio over red, green and blue, in dB: infinite where they are the same, 0 where they are of
// different sizes. As many pixels as `left_out_pixels`, those that differ most, do not count.
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

}  // namespace throng::bench
