// GLSL's types and functions for C++, as far as the .glsl texts use them that compile as both. C++ includes such a text
// into a class, whose members are what the text says that its includer declares. A text that counts in `Real` finds
// there what that is, and vectors of it; one that counts in float computes what a device does, with -ffp-contract=off.
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

#ifdef __clang__
#pragma clang diagnostic ignored "-Wnested-anon-types"
#endif
template <class T>
struct Vector4 {
    union {
        __extension__ struct { T x, y, z, w; };
        Vector3<T> xyz;
    };

    Vector4() = default;
    explicit Vector4(T all) : Vector4(all, all, all, all) {}
    Vector4(T x_, T y_, T z_, T w_) : x(x_), y(y_), z(z_), w(w_) {}
    Vector4(const Vector3<T>& v, T w_) : Vector4(v.x, v.y, v.z, w_) {}
    const T& operator[](uint i) const { return i == 3 ? w : xyz[i]; }
};

using vec3 = Vector3<float>;
using uvec3 = Vector3<uint>;

template <class T>
using Scalar = std::type_identity_t<T>;  // whatever number it is given as

using std::abs;
using std::exp;
using std::exp2;
using std::floor;
using std::isnan;
using std::pow;
using std::sqrt;
template <class T>
T fract(T x) {
    return x - floor(x);
}
template <class T>
T inversesqrt(T x) {
    return 1 / sqrt(x);
}
inline uint findLSB(uint bits) { return static_cast<uint>(std::countr_zero(bits)); }
inline float uintBitsToFloat(uint bits) { return std::bit_cast<float>(bits); }

// The second one where one of the two is NaN, as on devices.
template <class T>
T min(T a, Scalar<T> b) {
    return a < b ? a : b;
}
template <class T>
T max(T a, Scalar<T> b) {
    return a > b ? a : b;
}
template <class T>
T clamp(T x, Scalar<T> low, Scalar<T> high) {
    return min(max(x, low), high);
}
template <class T>
T smoothstep(Scalar<T> from, Scalar<T> to, T x) {
    const T t = clamp((x - from) / (to - from), 0, 1);
    return t * t * (3 - 2 * t);
}

// As control/rounded.glsl.
inline float sum(float a, float b) { return a + b; }
inline float difference(float a, float b) { return a - b; }
inline float product(float a, float b) { return a * b; }

template <class T>
Vector3<T> operator+(const Vector3<T>& a, const Vector3<T>& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class T>
Vector3<T> operator-(const Vector3<T>& a, const Vector3<T>& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class T>
Vector3<T> operator-(const Vector3<T>& v) {
    return {-v.x, -v.y, -v.z};
}
template <class T>
Vector3<T> operator*(const Vector3<T>& a, const Vector3<T>& b) {
    return {a.x * b.x, a.y * b.y, a.z * b.z};
}
template <class T>
Vector3<T> operator*(const Vector3<T>& v, Scalar<T> s) {
    return {v.x * s, v.y * s, v.z * s};
}
template <class T>
Vector3<T> operator*(Scalar<T> s, const Vector3<T>& v) {
    return v * s;
}
template <class T>
Vector3<T> operator/(const Vector3<T>& v, Scalar<T> s) {
    return {v.x / s, v.y / s, v.z / s};
}
template <class T>
Vector3<T> max(const Vector3<T>& a, const Vector3<T>& b) {
    return {max(a.x, b.x), max(a.y, b.y), max(a.z, b.z)};
}
template <class T>
Vector3<T> mix(const Vector3<T>& a, const Vector3<T>& b, Scalar<T> part) {
    return a * (1 - part) + b * part;
}
template <class T>
T dot(const Vector3<T>& a, const Vector3<T>& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class T>
Vector3<T> cross(const Vector3<T>& a, const Vector3<T>& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class T>
T length(const Vector3<T>& v) {
    return sqrt(dot(v, v));
}
template <class T>
T distance(const Vector3<T>& a, const Vector3<T>& b) {
    return length(b - a);
}
template <class T>
Vector3<T> normalize(const Vector3<T>& v) {
    return v / length(v);
}
template <class T>
Vector3<T> reflect(const Vector3<T>& way, const Vector3<T>& normal) {
    return way - normal * (2 * dot(normal, way));
}

template <class T>
Vector4<T> operator+(const Vector4<T>& a, const Vector4<T>& b) {
    return {a.xyz + b.xyz, a.w + b.w};
}
template <class T>
Vector4<T> operator*(const Vector4<T>& v, Scalar<T> s) {
    return {v.xyz * s, v.w * s};
}
template <class T>
Vector4<T> operator*(Scalar<T> s, const Vector4<T>& v) {
    return v * s;
}
template <class T>
T dot(const Vector4<T>& a, const Vector4<T>& b) {
    return dot(a.xyz, b.xyz) + a.w * b.w;
}

}  // namespace throng::io
