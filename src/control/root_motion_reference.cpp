#include "control/root_motion_reference.h"

#include <algorithm>
#include <cmath>

namespace throng {

GroundMove operator*(const GroundMove& a, const GroundMove& b) {
    return {.x = a.cos * b.x + a.sin * b.z + a.x,
            .z = -a.sin * b.x + a.cos * b.z + a.z,
            .cos = a.cos * b.cos - a.sin * b.sin,
            .sin = a.sin * b.cos + a.cos * b.sin};
}

GroundMove inverse(const GroundMove& a) {
    return {.x = -(a.cos * a.x - a.sin * a.z), .z = -(a.sin * a.x + a.cos * a.z), .cos = a.cos, .sin = -a.sin};
}

GroundMove power(GroundMove a, int64_t exponent) {
    if (exponent < 0) return power(inverse(a), -exponent);
    GroundMove product;
    for (; exponent > 0; exponent /= 2) {
        if (exponent % 2 == 1) product = product * a;
        a = a * a;
    }
    return product;
}

GroundMove place_at(RootRows rows, uint32_t phase) {
    if (rows.empty()) return {};
    const double position = phase * 0x1p-32 * static_cast<double>(rows.size() - 1);
    const auto row = static_cast<size_t>(position);
    const auto &from = rows[row], &to = rows[std::min(row + 1, rows.size() - 1)];
    const double fraction = position - static_cast<double>(row);
    const auto mix = [&](size_t i) { return from[i] + fraction * (double{to[i]} - from[i]); };
    return turned_to_length_one({mix(0), mix(1), mix(2), mix(3)});
}

GroundMove move_between(RootRows rows, uint32_t phase_before, uint32_t phase_after, int64_t crossed) {
    if (rows.empty()) return {};
    const auto& last = rows.back();
    const GroundMove cycle = turned_to_length_one({last[0], last[1], last[2], last[3]});
    return inverse(place_at(rows, phase_before)) * power(cycle, crossed) * place_at(rows, phase_after);
}

void add_weighted(GroundMove& sum, const GroundMove& move, double weight) {
    sum = {sum.x + weight * move.x, sum.z + weight * move.z, sum.cos + weight * move.cos, sum.sin + weight * move.sin};
}

GroundMove turned_to_length_one(const GroundMove& sum) {
    const double length = std::hypot(sum.cos, sum.sin);
    return length > 1e-6 ? GroundMove{sum.x, sum.z, sum.cos / length, sum.sin / length}
                         : GroundMove{sum.x, sum.z, 1, 0};
}

}  // namespace throng
