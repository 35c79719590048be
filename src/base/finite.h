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
template <class T, size_t kCount>
bool all_finite(const std::array<T, kCount>& items) {
    return std::ranges::all_of(items, [](const T& item) { return all_finite(item); });
}
template <class T>
bool all_finite(const std::vector<T>& items) {
    return std::ranges::all_of(items, [](const T& item) { return all_finite(item); });
}

}  // namespace throng
