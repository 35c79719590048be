#include "tools/creatures/creature_math.h"

namespace throng::creature {

// Shepperd, "Quaternion from rotation matrix", 1978: divide by the largest component.
Rotation rotation_to(const Vec& up, const Vec& forward) {
    const Vec side = cross(up, forward);
    const double m[3][3] = {{side.x, up.x, forward.x}, {side.y, up.y, forward.y}, {side.z, up.z, forward.z}};
    const double trace = m[0][0] + m[1][1] + m[2][2];
    if (trace > 0) {
        const double w = std::sqrt(trace + 1) / 2;
        return normalized(
            Rotation{(m[2][1] - m[1][2]) / (4 * w), (m[0][2] - m[2][0]) / (4 * w), (m[1][0] - m[0][1]) / (4 * w), w});
    }
    int i = 0;
    if (m[1][1] > m[0][0]) i = 1;
    if (m[2][2] > m[i][i]) i = 2;
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    double v[3];
    v[i] = std::sqrt(1 + m[i][i] - m[j][j] - m[k][k]) / 2;
    v[j] = (m[j][i] + m[i][j]) / (4 * v[i]);
    v[k] = (m[k][i] + m[i][k]) / (4 * v[i]);
    return normalized(Rotation{v[0], v[1], v[2], (m[k][j] - m[j][k]) / (4 * v[i])});
}

// Catmull-Rom; the curve goes straight on beyond its ends.
Station Outline::at(double t) const {
    const int last = int(stations_.size()) - 1;
    const double scaled = std::clamp(t, 0.0, 1.0) * last;
    const int i = std::min(int(scaled), last - 1);
    const double x = scaled - i;
    const double w[4] = {x * (-1 + x * (2 - x)) / 2, 1 + x * x * (3 * x - 5) / 2, x * (1 + x * (4 - 3 * x)) / 2,
                         x * x * (x - 1) / 2};
    const auto blend = [&](auto value) {
        const auto b = value(stations_[size_t(i)]), c = value(stations_[size_t(i) + 1]);
        const auto a = i > 0 ? value(stations_[size_t(i) - 1]) : b * 2.0 - c;
        const auto d = i + 2 <= last ? value(stations_[size_t(i) + 2]) : c * 2.0 - b;
        return a * w[0] + b * w[1] + c * w[2] + d * w[3];
    };
    return {blend([](const Station& s) { return s.center; }),
            std::max(0.0, blend([](const Station& s) { return s.width; })),
            std::max(0.0, blend([](const Station& s) { return s.height; }))};
}

Vec Outline::direction(double t) const {
    constexpr double kStep = 1e-4;  // of the whole length
    const double middle = std::clamp(t, kStep, 1 - kStep);
    return normalized(at(middle + kStep).center - at(middle - kStep).center);
}

}  // namespace throng::creature
