#include "control/control_reference.h"

#include <algorithm>
#include <cmath>

namespace throng {

double local_time_reference(double time_s, double duration_s, bool loop) {
    if (duration_s <= 0) return 0;
    if (!loop) return std::clamp(time_s, 0.0, duration_s);
    const double wrapped = time_s - std::floor(time_s / duration_s) * duration_s;
    return wrapped >= duration_s || wrapped < 0 ? 0 : wrapped;
}

RowCursor find_rows_reference(std::span<const float> times_s, double time_s) {
    const auto next = std::upper_bound(times_s.begin(), times_s.end(), time_s);
    const auto last = static_cast<uint32_t>(times_s.size() - 1);
    if (next == times_s.begin()) return {0, 0, 0};
    if (next == times_s.end()) return {last, last, 0};
    const auto later = static_cast<uint32_t>(next - times_s.begin());
    const double from_s = times_s[later - 1], to_s = times_s[later];
    return {later - 1, later, (time_s - from_s) / (to_s - from_s)};
}

}  // namespace throng
