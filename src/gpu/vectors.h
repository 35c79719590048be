// GLSL's vectors for C++, as shaders have them in memory, with the swizzles that texts use (gpu/glsl.h). A swizzle of
// adjacent members is itself a vector at the same address; others are converted to one when read.
#pragma once

#include <cstdint>
#include <type_traits>

namespace throng::io {

using uint = uint32_t;

// Members kFrom of a vector of T, in this order, as a V.
template <class V, class T, uint... kFrom>
struct Swizzle {
    T all[(0 | ... | kFrom) + 1];  // reaches at least to the largest index
    constexpr operator V() const { return V(all[kFrom]...); }
};

#ifdef __clang__
#pragma clang diagnostic ignored "-Wnested-anon-types"
#endif

// The operators of all vectors V of T. They are friends, so that swizzles and numbers convert to the parameter types.
template <class V, class T>
struct VectorOperators {
    using Number = T;

    friend constexpr V operator+(const V& a, const V& b) {
        return V::each([](T p, T q) { return p + q; }, a, b);
    }
    friend constexpr V operator-(const V& a, const V& b) {
        return V::each([](T p, T q) { return p - q; }, a, b);
    }
    friend constexpr V operator*(const V& a, const V& b) {
        return V::each([](T p, T q) { return p * q; }, a, b);
    }
    friend constexpr V operator/(const V& a, const V& b) {
        return V::each([](T p, T q) { return p / q; }, a, b);
    }
    friend constexpr V operator+(const V& v, T s) { return v + V(s); }
    friend constexpr V operator-(const V& v, T s) { return v - V(s); }
    friend constexpr V operator*(const V& v, T s) { return v * V(s); }
    friend constexpr V operator/(const V& v, T s) { return v / V(s); }
    friend constexpr V operator+(T s, const V& v) { return V(s) + v; }
    friend constexpr V operator-(T s, const V& v) { return V(s) - v; }
    friend constexpr V operator*(T s, const V& v) { return V(s) * v; }
    friend constexpr V operator-(const V& v) {
        return V::each([](T p) { return -p; }, v);
    }
    friend constexpr V& operator+=(V& a, const V& b) { return a = a + b; }
    friend constexpr V& operator*=(V& a, T s) { return a = a * s; }
    friend constexpr V operator|(const V& a, const V& b) {
        return V::each([](T p, T q) { return p | q; }, a, b);
    }
    friend constexpr V operator&(const V& v, T s) {
        return V::each([s](T p) { return p & s; }, v);
    }
    friend constexpr V operator>>(const V& v, T s) {
        return V::each([s](T p) { return p >> s; }, v);
    }
    friend constexpr V operator<<(const V& v, T s) {
        return V::each([s](T p) { return p << s; }, v);
    }
};

template <class T>
struct Vector2 : VectorOperators<Vector2<T>, T> {
    union {
        __extension__ struct { T x, y; };
        Swizzle<Vector2, T, 1, 0> yx;
    };

    Vector2() = default;
    constexpr explicit Vector2(T all) : Vector2(all, all) {}
    constexpr Vector2(T x_, T y_) : x(x_), y(y_) {}
    template <class U>
    constexpr explicit Vector2(const Vector2<U>& v) : Vector2(static_cast<T>(v.x), static_cast<T>(v.y)) {}
    template <class F, class... A>
    static constexpr auto each(const F& f, const A&... a) {
        return Vector2<decltype(f(a.x...))>(f(a.x...), f(a.y...));
    }
};

template <class T>
struct Vector3 : VectorOperators<Vector3<T>, T> {
    union {
        __extension__ struct { T x, y, z; };
        Vector2<T> xy;
        Swizzle<Vector2<T>, T, 1, 0> yx;
        __extension__ struct {
            T before_yz;
            Vector2<T> yz;
        };
    };

    Vector3() = default;
    constexpr explicit Vector3(T all) : Vector3(all, all, all) {}
    constexpr Vector3(T x_, T y_, T z_) : x(x_), y(y_), z(z_) {}
    constexpr Vector3(const Vector2<T>& v, T z_) : Vector3(v.x, v.y, z_) {}
    template <class U>
    constexpr explicit Vector3(const Vector3<U>& v)
        : Vector3(static_cast<T>(v.x), static_cast<T>(v.y), static_cast<T>(v.z)) {}
    T& operator[](uint i) { return i == 0 ? x : i == 1 ? y : z; }
    const T& operator[](uint i) const { return i == 0 ? x : i == 1 ? y : z; }
    template <class F, class... A>
    static constexpr auto each(const F& f, const A&... a) {
        return Vector3<decltype(f(a.x...))>(f(a.x...), f(a.y...), f(a.z...));
    }
};

template <class T>
struct alignas(sizeof(T) == 4 ? 16 : alignof(T)) Vector4 : VectorOperators<Vector4<T>, T> {
    union {
        __extension__ struct { T x, y, z, w; };
        Vector3<T> xyz;
        Vector2<T> xy;
        __extension__ struct {
            T before_zw[2];
            Vector2<T> zw;
        };
        Swizzle<Vector2<T>, T, 0, 2> xz;
        Swizzle<Vector3<T>, T, 3, 3, 3> www;
        Swizzle<Vector4, T, 3, 0, 1, 2> wxyz;
        Swizzle<Vector4, T, 2, 3, 0, 1> zwxy;
    };

    Vector4() = default;
    constexpr explicit Vector4(T all) : Vector4(all, all, all, all) {}
    constexpr Vector4(T x_, T y_, T z_, T w_) : x(x_), y(y_), z(z_), w(w_) {}
    constexpr Vector4(const Vector3<T>& v, T w_) : Vector4(v.x, v.y, v.z, w_) {}
    constexpr Vector4(const Vector2<T>& v, const Vector2<T>& v_) : Vector4(v.x, v.y, v_.x, v_.y) {}
    constexpr Vector4(const Vector2<T>& v, T z_, T w_) : Vector4(v.x, v.y, z_, w_) {}
    constexpr Vector4(T x_, T y_, const Vector2<T>& v) : Vector4(x_, y_, v.x, v.y) {}
    template <class U>
    constexpr explicit Vector4(const Vector4<U>& v)
        : Vector4(static_cast<T>(v.x), static_cast<T>(v.y), static_cast<T>(v.z), static_cast<T>(v.w)) {}
    T& operator[](uint i) { return i == 3 ? w : xyz[i]; }
    const T& operator[](uint i) const { return i == 3 ? w : xyz[i]; }
    template <class F, class... A>
    static constexpr auto each(const F& f, const A&... a) {
        return Vector4<decltype(f(a.x...))>(f(a.x...), f(a.y...), f(a.z...), f(a.w...));
    }
};

using vec2 = Vector2<float>;
using vec3 = Vector3<float>;
using vec4 = Vector4<float>;
using ivec2 = Vector2<int>;
using uvec2 = Vector2<uint>;
using uvec3 = Vector3<uint>;
using uvec4 = Vector4<uint>;
using bvec4 = Vector4<bool>;

}  // namespace throng::io
