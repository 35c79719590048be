#include "update_rate/update_rate_reference.h"

namespace throng {

AffineT<double> update_rate_reference(const AffineT<double>& previous, const AffineT<double>& target, uint32_t step) {
    AffineT<double> out;
    for (size_t row = 0; row < 3; ++row)
        for (size_t column = 0; column < 4; ++column)
            out.row[row][column] = previous.row[row][column] +
                                   (target.row[row][column] - previous.row[row][column]) / step;
    return out;
}

uint32_t period_reference(double size_pixels, double full_rate_pixels) {
    uint32_t period = 1;
    while (period < 8 && size_pixels * period < full_rate_pixels) period *= 2;
    return period;
}

}  // namespace throng
