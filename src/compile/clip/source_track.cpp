#include "compile/clip/source_track.h"

#include "control/control_reference.h"
#include "sample/sample_reference.h"

#include <algorithm>

namespace throng {
namespace {

Quaternion<double> quaternion(const TrackValue& v) { return normalized(Quaternion<double>{v[0], v[1], v[2], v[3]}); }
TrackValue value_of(const Quaternion<double>& q) { return {q.x, q.y, q.z, q.w}; }

TrackValue mix(const TrackValue& a, const TrackValue& b, double w) {
    TrackValue out;
    for (size_t i = 0; i < 4; ++i) out[i] = a[i] * (1 - w) + b[i] * w;
    return out;
}

}  // namespace

TrackValue SourceTrack::value(size_t index) const {
    const size_t components = track_.target == TrackTarget::kRotation ? 4 : 3;
    TrackValue out{};
    for (size_t i = 0; i < components; ++i) out[i] = track_.values[index * components + i];
    return out;
}

TrackValue SourceTrack::mapped(const TrackValue& v) const {
    if (track_.target == TrackTarget::kRotation) return value_of(prefix_.rotation * quaternion(v));
    const Vec3<double> out = track_.target == TrackTarget::kTranslation
                                 ? prefix_.point({v[0], v[1], v[2]})
                                 : Vec3<double>{v[0], v[1], v[2]} * prefix_.scale;
    return {out.x, out.y, out.z, 0};
}

bool SourceTrack::is_constant() const {
    const size_t components = track_.target == TrackTarget::kRotation ? 4 : 3;
    const bool cubic = track_.interpolation == Interpolation::kCubicSpline;
    const size_t key_size = components * (cubic ? 3 : 1), first = cubic ? components : 0;
    const auto& v = track_.values;
    for (size_t key = 0; key < track_.times_s.size(); ++key) {
        const auto at = v.begin() + static_cast<ptrdiff_t>(key * key_size);
        if (!std::equal(at + static_cast<ptrdiff_t>(first), at + static_cast<ptrdiff_t>(first + components),
                        v.begin() + static_cast<ptrdiff_t>(first)))
            return false;
        const auto is_zero = [](float tangent) { return tangent == 0; };
        if (cubic && track_.times_s.size() > 1 &&
            !(std::all_of(at, at + static_cast<ptrdiff_t>(components), is_zero) &&
              std::all_of(at + static_cast<ptrdiff_t>(2 * components), at + static_cast<ptrdiff_t>(3 * components),
                          is_zero)))
            return false;
    }
    return true;
}

TrackValue SourceTrack::evaluate(double time_s) const {
    const RowCursor keys = find_rows_reference(track_.times_s, time_s);
    const double w = keys.fraction;
    if (track_.interpolation != Interpolation::kCubicSpline) {
        const TrackValue a = value(keys.earlier), b = value(keys.later);
        if (track_.target == TrackTarget::kRotation)
            return mapped(interpolate_rows(track_.target, track_.interpolation, value_of(quaternion(a)),
                                           value_of(quaternion(b)), w));
        return mapped(interpolate_rows(track_.target, track_.interpolation, a, b, w));
    }
    // In-tangent, value, out-tangent a key; tangents are per second.
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

TrackValue interpolate_rows(TrackTarget target, Interpolation interpolation, const TrackValue& earlier,
                            const TrackValue& later, double w) {
    if (interpolation == Interpolation::kStep) return earlier;
    if (target != TrackTarget::kRotation) return mix(earlier, later, w);
    return value_of(slerp_reference(quaternion(earlier), quaternion(later), w));
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
