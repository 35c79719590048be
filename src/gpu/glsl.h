// GLSL's types and functions for C++, as far as they are used by those .glsl texts that also compile as C++. C++
// includes such a text into a class, whose members are what the text asks its includer to declare. For a text that
// computes in `Real`, the class also defines that type and its vectors. A text that computes in float gives the same
// results as on a device if it is compiled with -ffp-contract=off. Whole kernels: gpu/native_text.h.
#pragma once

#include "gpu/shader_types.h"

#include <bit>
#include <cmath>
#include <type_traits>

namespace throng::io {

template <class V>
concept Vector = requires {
    typename V::Number;
};
template <class T>
concept Number = std::is_arithmetic_v<T>;
template <class T>
using Scalar = std::type_identity_t<T>;  // not deduced, so that any number converts

using std::abs;
using std::exp;
using std::exp2;
using std::floor;
using std::isnan;
using std::pow;
using std::sqrt;
inline float round(float x) { return std::nearbyint(x); }
template <Number T>
T fract(T x) {
    return x - floor(x);
}
template <Number T>
T inversesqrt(T x) {
    return 1 / sqrt(x);
}
template <Number T>
T sign(T x) {
    return static_cast<T>((x > 0) - (x < 0));
}

// The second argument if either is NaN, as on devices.
template <Number T>
T min(T a, Scalar<T> b) {
    return a < b ? a : b;
}
template <Number T>
T max(T a, Scalar<T> b) {
    return a > b ? a : b;
}
template <class T>
T clamp(const T& x, const Scalar<T>& low, const Scalar<T>& high) {
    return min(max(x, low), high);
}
template <Number T>
T mix(T a, Scalar<T> b, Scalar<T> part) {
    return a * (1 - part) + b * part;
}
template <Number T>
T smoothstep(Scalar<T> from, Scalar<T> to, T x) {
    const T t = clamp((x - from) / (to - from), 0, 1);
    return t * t * (3 - 2 * t);
}

// The same as in gpu/shader_types.h.
template <class T>
int truncated(T x) {
    return static_cast<int>(x);
}
template <class Yes, class No>
std::common_type_t<Yes, No> choose(bool condition, const Yes& yes, const No& no) {
    return condition ? std::common_type_t<Yes, No>(yes) : std::common_type_t<Yes, No>(no);
}
inline bool some(bool condition) { return condition; }

// ---- Bits

inline uint findLSB(uint bits) { return static_cast<uint>(std::countr_zero(bits)); }
inline int bitfieldExtract(int value, uint first, uint count) {
    return static_cast<int>(static_cast<uint>(value) << (32 - first - count)) >> (32 - count);
}
inline void umulExtended(uint a, uint b, uint& high, uint& low) {
    const uint64_t product = uint64_t{a} * b;
    high = static_cast<uint>(product >> 32);
    low = static_cast<uint>(product);
}
inline float uintBitsToFloat(uint bits) { return std::bit_cast<float>(bits); }
inline uint floatBitsToUint(float number) { return std::bit_cast<uint>(number); }
template <Vector V>
auto uintBitsToFloat(const V& v) {
    return V::each([](uint bits) { return uintBitsToFloat(bits); }, v);
}
template <Vector V>
auto floatBitsToUint(const V& v) {
    return V::each([](float number) { return floatBitsToUint(number); }, v);
}

// Rounds to nearest, ties to even.
inline uint half_of(float number) {
    const uint bits = floatBitsToUint(number), sign = bits >> 16 & 0x8000u, size = bits & 0x7FFFFFFFu;
    if (size > 0x7F800000u) return sign | 0x7E00u;
    if (size >= 0x47800000u) return sign | 0x7C00u;                                                  // 2^16
    if (size < 0x38800000u) return sign | (floatBitsToUint(uintBitsToFloat(size) + 0.5f) & 0x7FFu);  // 2^-14
    return sign | (size - (112u << 23) + 0xFFFu + (size >> 13 & 1)) >> 13;
}
inline float float_of(uint half) {
    const uint sign = (half & 0x8000u) << 16, size = half & 0x7FFFu;
    if (size < 0x400u) return uintBitsToFloat(sign | floatBitsToUint(static_cast<float>(size) * 0x1p-24f));
    return uintBitsToFloat(sign | ((size << 13) + (size < 0x7C00u ? 112u << 23 : 224u << 23)));
}
inline uint packHalf2x16(const vec2& v) { return half_of(v.x) | half_of(v.y) << 16; }
inline vec2 unpackHalf2x16(uint pair) { return {float_of(pair & 0xFFFFu), float_of(pair >> 16)}; }
inline uint packSnorm2x16(const vec2& v) {
    const auto rounded = [](float x) { return static_cast<uint>(static_cast<int>(round(clamp(x, -1, 1) * 32767))); };
    return (rounded(v.x) & 0xFFFFu) | rounded(v.y) << 16;
}
inline vec2 unpackSnorm2x16(uint pair) {
    const auto number = [](uint bits) { return max(static_cast<float>(static_cast<int16_t>(bits)) / 32767, -1); };
    return {number(pair & 0xFFFFu), number(pair >> 16)};
}

// As control/rounded.glsl.
inline float sum(float a, float b) { return a + b; }
inline float difference(float a, float b) { return a - b; }
inline float product(float a, float b) { return a * b; }

// ---- Vectors

template <Vector V>
V abs(const V& v) {
    return V::each([](auto x) { return abs(x); }, v);
}
template <class V, class T, uint... kFrom>
V abs(const Swizzle<V, T, kFrom...>& v) {
    return abs(V(v));
}
template <Vector V>
V floor(const V& v) {
    return V::each([](auto x) { return floor(x); }, v);
}
template <Vector V>
V round(const V& v) {
    return V::each([](auto x) { return round(x); }, v);
}
template <Vector V>
V fract(const V& v) {
    return V::each([](auto x) { return fract(x); }, v);
}
template <Vector V>
V min(const V& a, const Scalar<V>& b) {
    return V::each([](auto p, auto q) { return min(p, q); }, a, b);
}
template <Vector V>
V max(const V& a, const Scalar<V>& b) {
    return V::each([](auto p, auto q) { return max(p, q); }, a, b);
}
template <Vector V>
V mix(const V& a, const Scalar<V>& b, typename V::Number part) {
    return a * (1 - part) + b * part;
}
template <Vector V, Vector Chosen>
requires std::is_same_v<typename Chosen::Number, bool> V mix(const V& a, const V& b, const Chosen& second) {
    return V::each([](auto p, auto q, bool is_second) { return is_second ? q : p; }, a, b, second);
}
template <Vector V>
auto lessThan(const V& a, const V& b) {
    return V::each([](auto p, auto q) { return p < q; }, a, b);
}
template <Vector V>
auto greaterThanEqual(const V& a, const V& b) {
    return V::each([](auto p, auto q) { return p >= q; }, a, b);
}
template <Vector V>
auto notEqual(const V& a, const V& b) {
    return V::each([](auto p, auto q) { return p != q; }, a, b);
}
template <class T>
bool operator==(const Vector2<T>& a, const Vector2<T>& b) {
    return a.x == b.x && a.y == b.y;
}
template <class T>
bool operator==(const Vector4<T>& a, const Vector4<T>& b) {
    return a.x == b.x && a.y == b.y && a.z == b.z && a.w == b.w;
}

template <class T>
T dot(const Vector2<T>& a, const Vector2<T>& b) {
    return a.x * b.x + a.y * b.y;
}
template <class T>
T dot(const Vector3<T>& a, const Vector3<T>& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class T>
T dot(const Vector4<T>& a, const Vector4<T>& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z + a.w * b.w;
}
template <class T>
Vector3<T> cross(const Vector3<T>& a, const Vector3<T>& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <Vector V>
auto length(const V& v) {
    return sqrt(dot(v, v));
}
template <class V, class T, uint... kFrom>
auto length(const Swizzle<V, T, kFrom...>& v) {
    return length(V(v));
}
template <Vector V>
auto distance(const V& a, const Scalar<V>& b) {
    return length(b - a);
}
template <Vector V>
V normalize(const V& v) {
    return v / length(v);
}
template <class T>
Vector3<T> reflect(const Vector3<T>& way, const Vector3<T>& normal) {
    return way - normal * (2 * dot(normal, way));
}

}  // namespace throng::io
