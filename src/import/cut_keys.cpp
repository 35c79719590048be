#include "import/cut_keys.h"

#include "base/slerp.h"

#include <algorithm>
#include <array>
#include <span>

namespace throng::gltf {
namespace {

// Between the last key before time 0 and the first one after.
struct Interval {
    std::span<float> earlier;
    std::span<const float> later;
    double duration_s;
    double fraction;  // of the duration: where time 0 lies
};

// Each of these functions turns the earlier key into the one at time 0.
void cut_linear(const Interval& interval) {
    for (size_t i = 0; i < interval.earlier.size(); ++i)
        interval.earlier[i] = float(interval.earlier[i] * (1 - interval.fraction) +
                                    interval.later[i] * interval.fraction);
}

void cut_arc(const Interval& interval) {
    const auto rotation = [](std::span<const float> q) {
        return normalized(Quaternion<double>{q[0], q[1], q[2], q[3]});
    };
    const auto at_zero = slerp(rotation(interval.earlier), rotation(interval.later), interval.fraction).as<float>();
    std::ranges::copy(std::array{at_zero.x, at_zero.y, at_zero.z, at_zero.w}, interval.earlier.begin());
}

// A part of a cubic is a cubic too, given by the values and derivatives at its ends. A key has in-tangents, values and
// out-tangents; tangents are per second.
void cut_cubic(const Interval& interval) {
    const size_t count = interval.earlier.size() / 3;
    const double w = interval.fraction, w2 = w * w, w3 = w2 * w;
    for (size_t i = 0; i < count; ++i) {
        const double a = interval.earlier[count + i], b = interval.later[count + i],
                     out_tangent = interval.earlier[2 * count + i] * interval.duration_s,
                     in_tangent = interval.later[i] * interval.duration_s;
        const double value = (2 * w3 - 3 * w2 + 1) * a + (w3 - 2 * w2 + w) * out_tangent + (3 * w2 - 2 * w3) * b +
                             (w3 - w2) * in_tangent;
        const double derivative = (6 * w2 - 6 * w) * (a - b) + (3 * w2 - 4 * w + 1) * out_tangent +
                                  (3 * w2 - 2 * w) * in_tangent;
        interval.earlier[count + i] = float(value);
        interval.earlier[i] = interval.earlier[2 * count + i] = float(derivative / interval.duration_s);
    }
}

}  // namespace

void cut_before_zero(const CurveKeys& curve) {
    auto& [interpolation, is_rotation, times_s, values] = curve;
    const auto behind = size_t(std::ranges::lower_bound(times_s, 0.0f) - times_s.begin());
    if (behind == 0) return;
    const size_t width = values.size() / times_s.size();  // of a key
    const auto key = [&](size_t index) { return std::span(values).subspan(index * width, width); };
    const bool are_all_before = behind == times_s.size();
    size_t first = behind - 1;
    if (!are_all_before && times_s[behind] == 0) {
        first = behind;
    } else if (!are_all_before && interpolation != Interpolation::kStep) {
        const double earlier_s = times_s[first], duration_s = times_s[behind] - earlier_s;
        const Interval interval{key(first), key(behind), duration_s, -earlier_s / duration_s};
        if (interpolation == Interpolation::kCubicSpline)
            cut_cubic(interval);
        else if (is_rotation)
            cut_arc(interval);
        else
            cut_linear(interval);
    }
    times_s.erase(times_s.begin(), times_s.begin() + ptrdiff_t(first));
    values.erase(values.begin(), values.begin() + ptrdiff_t(first * width));
    times_s.front() = 0;
}

}  // namespace throng::gltf
