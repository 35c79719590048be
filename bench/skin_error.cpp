#include "bench/skin_error.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace throng::bench {

double skin_error(std::span<const Affine> got, std::span<const AffineT<double>> wanted, double size) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    if (got.size() != wanted.size()) return kInfinity;
    double worst = 0;
    for (size_t entry = 0; entry < got.size(); ++entry)
        for (size_t row = 0; row < 3; ++row)
            for (size_t column = 0; column < 4; ++column) {
                const double difference = std::abs(got[entry].row[row][column] - wanted[entry].row[row][column]);
                if (!(difference >= 0)) return kInfinity;
                worst = std::max(worst, column == 3 ? difference / std::max(size, 1e-30) : difference);
            }
    return worst;
}

}  // namespace throng::bench
