// How far two pictures are apart.
#pragma once

#include <throng/draw.h>

#include <cmath>
#include <limits>

namespace throng::test {

// Peak signal to noise ratio over red, green and blue, in dB: infinite where they are the same, 0 where they are of
// different sizes.
inline double psnr(const Picture& a, const Picture& b) {
    if (a.rgba.size() != b.rgba.size() || a.width != b.width) return 0;
    double sum = 0;
    for (size_t i = 0; i < a.rgba.size(); ++i) {
        if (i % 4 == 3) continue;
        const double difference = double(a.rgba[i]) - double(b.rgba[i]);
        sum += difference * difference;
    }
    const double mean = sum / (0.75 * static_cast<double>(a.rgba.size()));
    return mean == 0 ? std::numeric_limits<double>::infinity() : 10 * std::log10(255 * 255 / mean);
}

}  // namespace throng::test
