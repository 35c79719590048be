// GLSL's types and functions for C++, as far as the .glsl texts use them that compile as both. C++ includes such a text
// into a class, whose members are what the text says that its includer declares. Compiled with -ffp-contract=off it
// computes what a device does.
#pragma once

#include "gpu/shader_types.h"

#include <bit>
#include <cmath>
#include <type_traits>

namespace throng::io {

template <class T>
struct Vector3 {
    T x, y, z;

    Vector3() = default;
    explicit Vector3(T all) : Vector3(all, all, all) {}
    Vector3(T x_, T y_, T z_) : x(x_), y(y_), z(z_) {}
    T& operator[](uint i) { return i == 0 ? x : i == 1 ? y : z; }
    const T& operator[](uint i) const { return i == 0 ? x : i == 1 ? y : z; }
};
using vec3 = Vector3<float>;
using uvec3 = Vector3<uint>;

using std::abs;
using std::floor;
using std::isnan;
inline uint findLSB(uint bits) { return static_cast<uint>(std::countr_zero(bits)); }
inline float uintBitsToFloat(uint bits) { return std::bit_cast<float>(bits); }

// Of a number and NaN, the number, as on devices.
template <class T>
T min(T a, std::type_identity_t<T> b) {
    return a < b ? a : b;
}
template <class T>
T max(T a, std::type_identity_t<T> b) {
    return a > b ? a : b;
}
inline vec3 max(vec3 a, vec3 b) { return {max(a.x, b.x), max(a.y, b.y), max(a.z, b.z)}; }
template <class T>
T clamp(T x, std::type_identity_t<T> low, std::type_identity_t<T> high) {
    return min(max(x, low), high);
}

// As control/rounded.glsl.
inline float sum(float a, float b) { return a + b; }
inline float difference(float a, float b) { return a - b; }
inline float product(float a, float b) { return a * b; }

}  // namespace throng::io
