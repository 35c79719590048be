#include "compile/clip/source_track.h"

#include "sample/sample_reference.h"

#include <algorithm>

namespace throng {
namespace {

TrackValue unit(const TrackValue& v) { return value_of(normalized(quaternion_of(v))); }

}  // namespace

TrackValue SourceTrack::value(size_t index) const {
    const size_t components = track_.target == TrackTarget::kRotation ? 4 : 3;
    TrackValue out{};
    for (size_t i = 0; i < components; ++i) out[i] = track_.values[index * components + i];
    return out;
}

TrackValue SourceTrack::mapped(const TrackValue& v) const {
    if (track_.target == TrackTarget::kRotation) return value_of(prefix_.rotation * normalized(quaternion_of(v)));
    return value_of(track_.target == TrackTarget::kTranslation ? prefix_.point(vector_of(v))
                                                               : vector_of(v) * prefix_.scale);
}

bool SourceTrack::is_constant() const {
    const bool cubic = track_.interpolation == Interpolation::kCubicSpline;
    const size_t key_count = track_.times_s.size(), values_a_key = cubic ? 3 : 1, first = cubic ? 1 : 0;
    for (size_t key = 0; key < key_count; ++key) {
        const size_t at = key * values_a_key;
        if (value(at + first) != value(first)) return false;
        if (cubic && key_count > 1 && (value(at) != TrackValue{} || value(at + 2) != TrackValue{})) return false;
    }
    return true;
}

TrackValue SourceTrack::evaluate(double time_s) const {
    const RowCursor keys = find_rows_reference(track_.times_s, time_s);
    const double w = keys.fraction;
    if (track_.interpolation != Interpolation::kCubicSpline) {
        const bool rotates = track_.target == TrackTarget::kRotation;
        const auto key = [&](uint32_t index) { return rotates ? unit(value(index)) : value(index); };
        const TrackValue earlier = key(keys.earlier);
        return mapped(track_.interpolation == Interpolation::kStep
                          ? earlier
                          : interpolate_reference(track_.target, earlier, key(keys.later), w));
    }
    // Each key has an in-tangent, a value and an out-tangent; tangents are per second.
    const TrackValue a = value(keys.earlier * 3 + 1), b = value(keys.later * 3 + 1);
    if (keys.earlier == keys.later) return mapped(a);
    const double interval_s = double{track_.times_s[keys.later]} - track_.times_s[keys.earlier];
    const TrackValue out_tangent = value(keys.earlier * 3 + 2), in_tangent = value(keys.later * 3);
    const double w2 = w * w, w3 = w2 * w;
    TrackValue sum;
    for (size_t i = 0; i < 4; ++i)
        sum[i] = (2 * w3 - 3 * w2 + 1) * a[i] + interval_s * (w3 - 2 * w2 + w) * out_tangent[i] +
                 (3 * w2 - 2 * w3) * b[i] + interval_s * (w3 - w2) * in_tangent[i];
    return mapped(sum);
}

double distance(TrackTarget target, const TrackValue& a, const TrackValue& b) {
    const auto norm_of_difference = [&](double sign) {
        double sum = 0;
        for (size_t i = 0; i < 4; ++i) sum += (a[i] - sign * b[i]) * (a[i] - sign * b[i]);
        return std::sqrt(sum);
    };
    if (target != TrackTarget::kRotation) return norm_of_difference(1);
    return 4 * std::asin(std::min(1.0, std::min(norm_of_difference(1), norm_of_difference(-1)) / 2));
}

}  // namespace throng
