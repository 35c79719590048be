// GLSL's vectors and functions for lanes: those that draw/*_model.glsl uses. They are plain structs, since compilers
// keep those in registers, but not unions.
#pragma once

#include "raster/lane_types.h"

namespace {

// The same in all lanes.
struct Numbers {
    float x, y, z, w;
};

struct vec2 {
    using Number = Real;
    Real x, y;
    vec2() = default;
    INLINE vec2(Real x_, Real y_) : x(x_), y(y_) {}
    INLINE explicit vec2(Real all) : vec2(all, all) {}
    template <class F, class... A>
    static INLINE vec2 each(const F& f, const A&... a) {
        return {f(a.x...), f(a.y...)};
    }
};

struct vec3 {
    using Number = Real;
    Real x, y, z;
    vec3() = default;
    INLINE vec3(Real x_, Real y_, Real z_) : x(x_), y(y_), z(z_) {}
    INLINE explicit vec3(Real all) : vec3(all, all, all) {}
    template <class F, class... A>
    static INLINE vec3 each(const F& f, const A&... a) {
        return {f(a.x...), f(a.y...), f(a.z...)};
    }
};

struct vec4 {
    using Number = Real;
    Real x, y, z, w;
    vec4() = default;
    INLINE vec4(Real x_, Real y_, Real z_, Real w_) : x(x_), y(y_), z(z_), w(w_) {}
    INLINE vec4(const vec3& v, Real w_) : vec4(v.x, v.y, v.z, w_) {}
    INLINE explicit vec4(Real all) : vec4(all, all, all, all) {}
    INLINE explicit vec4(const Numbers& all) : vec4(all.x, all.y, all.z, all.w) {}
    template <class F, class... A>
    static INLINE vec4 each(const F& f, const A&... a) {
        return {f(a.x...), f(a.y...), f(a.z...), f(a.w...)};
    }
};

INLINE vec3 xyz(const vec4& v) { return {v.x, v.y, v.z}; }
INLINE vec3 xyz(const Numbers& all) { return {all.x, all.y, all.z}; }

template <class V>
concept Vector = requires {
    typename V::Number;
};

struct Sum {
    INLINE Real operator()(Real a, Real b) const { return a + b; }
};
struct Difference {
    INLINE Real operator()(Real a, Real b) const { return a - b; }
};
struct Product {
    INLINE Real operator()(Real a, Real b) const { return a * b; }
};
struct Chosen {
    Mask condition;
    INLINE Real operator()(Real yes, Real no) const { return choose(condition, yes, no); }
};

template <Vector V>
INLINE V operator+(const V& a, const V& b) {
    return V::each(Sum(), a, b);
}
template <Vector V>
INLINE V operator-(const V& a, const V& b) {
    return V::each(Difference(), a, b);
}
template <Vector V>
INLINE V operator*(const V& a, const V& b) {
    return V::each(Product(), a, b);
}
template <Vector V>
INLINE V operator+(const V& v, Real s) {
    return v + V(s);
}
template <Vector V>
INLINE V operator-(const V& v, Real s) {
    return v - V(s);
}
template <Vector V>
INLINE V operator*(const V& v, Real s) {
    return v * V(s);
}
template <Vector V>
INLINE V operator*(Real s, const V& v) {
    return v * V(s);
}
template <Vector V>
INLINE V operator/(const V& v, Real s) {
    return v * V(inverse(s));
}
template <Vector V>
INLINE V operator-(const V& v) {
    return V(0) - v;
}
template <Vector V>
INLINE V& operator+=(V& a, const V& b) {
    return a = a + b;
}

INLINE Real dot(const vec2& a, const vec2& b) { return a.x * b.x + a.y * b.y; }
INLINE Real dot(const vec3& a, const vec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
INLINE Real dot(const vec4& a, const vec4& b) { return a.x * b.x + a.y * b.y + a.z * b.z + a.w * b.w; }
INLINE Real length(const vec3& v) { return sqrt(dot(v, v)); }
INLINE vec3 normalize(const vec3& v) { return v * inversesqrt(dot(v, v)); }
INLINE vec3 reflect(const vec3& way, const vec3& normal) { return way - normal * (2 * dot(normal, way)); }
INLINE vec2 abs(const vec2& v) { return {abs(v.x), abs(v.y)}; }
INLINE vec3 max(const vec3& a, const vec3& b) { return {max(a.x, b.x), max(a.y, b.y), max(a.z, b.z)}; }
template <Vector V>
INLINE V mix(const V& a, const V& b, Real part) {
    return a + (b - a) * part;
}
template <Vector V>
INLINE V choose(Mask condition, const V& yes, const V& no) {
    return V::each(Chosen{condition}, yes, no);
}

INLINE Mask operator!(Mask a) { return ~a; }
INLINE Mask operator&&(Mask a, Mask b) { return a & b; }
INLINE Mask operator||(Mask a, Mask b) { return a | b; }

// For a constant exponent of at least 0: the loop is unrolled.
INLINE Real pow(Real base, int exponent) {
    Real power = 1;
    for (; exponent > 0; exponent /= 2, base = base * base)
        if (exponent % 2 == 1) power = power * base;
    return power;
}

// GLSL's uint.
struct Word {
    Whole bits;
    INLINE Word(uint32_t all) : bits(static_cast<int32_t>(all)) {}
    INLINE explicit Word(Whole whole) : bits(whole) {}
    INLINE explicit operator Real() const { return Real(bits); }  // below 2^31
};
INLINE Word operator+(Word a, Word b) { return Word(a.bits + b.bits); }
INLINE Word operator*(Word a, Word b) { return Word(a.bits * b.bits); }
INLINE Word operator&(Word a, Word b) { return Word(a.bits & b.bits); }
INLINE Word operator^(Word a, Word b) { return Word(a.bits ^ b.bits); }
INLINE Word operator>>(Word a, int by) { return Word((a.bits >> by) & static_cast<int32_t>(0xFFFFFFFFu >> by)); }

}  // namespace
