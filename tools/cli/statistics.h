// What repeated measurements say.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

namespace throng {

struct Spread {
    double p5 = 0, median = 0, p95 = 0;
};

// Each is one of the values (nearest rank); zeros if there are no values.
inline Spread spread_of(std::vector<double> values) {
    if (values.empty()) return {};
    std::sort(values.begin(), values.end());
    const auto at = [&](double quantile) {
        return values[static_cast<size_t>(std::lround(quantile * static_cast<double>(values.size() - 1)))];
    };
    return {at(0.05), at(0.5), at(0.95)};
}

}  // namespace throng
