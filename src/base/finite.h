// Whether all numbers of something are finite.
#pragma once

#include <throng/transform.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace throng {

inline bool all_finite(double number) { return std::isfinite(number); }
template <class T>
bool all_finite(const Vec3<T>& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}
template <class T>
bool all_finite(const Quaternion<T>& q) {
    return std::isfinite(q.x) && std::isfinite(q.y) && std::isfinite(q.z) && std::isfinite(q.w);
}
template <class T>
bool all_finite(const Trs<T>& trs) {
    return all_finite(trs.rotation) && all_finite(trs.translation) && all_finite(trs.scale);
}
template <class T, size_t kCount>
bool all_finite(const std::array<T, kCount>& items) {
    return std::ranges::all_of(items, [](const T& item) { return all_finite(item); });
}
template <class T>
bool all_finite(const AffineT<T>& affine) {
    return all_finite(affine.row);
}
template <class T>
bool all_finite(const std::vector<T>& items) {
    return std::ranges::all_of(items, [](const T& item) { return all_finite(item); });
}

}  // namespace throng
