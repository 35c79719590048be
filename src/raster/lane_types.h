// Numbers with as many lanes as the instruction set has, for code that is written for single numbers. Include a
// native/lanes_*.h, which defines Lanes, first.
#pragma once

#include <cstdint>
#include <type_traits>

#define INLINE __attribute__((always_inline)) inline

namespace {

using std::uint32_t;

struct Mask {
    Lanes::Mask m;
};
INLINE Mask operator&(Mask a, Mask b) { return {Lanes::both(a.m, b.m)}; }
INLINE Mask operator|(Mask a, Mask b) { return {Lanes::either(a.m, b.m)}; }
INLINE Mask operator~(Mask a) { return {Lanes::none_of(a.m)}; }
INLINE uint32_t bits(Mask m) { return Lanes::bits(m.m); }
INLINE bool any(Mask m) { return bits(m) != 0; }
INLINE bool some(Mask m) { return any(m); }  // as the shaders call it
INLINE Mask mask_of(uint32_t bits) { return {Lanes::mask_of(bits)}; }
constexpr uint32_t kAllLanes = (1u << Lanes::kCount) - 1;
INLINE Mask first_lanes(uint32_t count) {
    return mask_of(count >= static_cast<uint32_t>(Lanes::kCount) ? kAllLanes : (1u << count) - 1);
}

// Each lane has a 32-bit integer.
struct Whole {
    Lanes::Words v;
    Whole() = default;
    template <class T>
    requires std::is_same_v<T, int32_t> INLINE Whole(T all) : v(Lanes::Words{} + all) {}  // not from a float
    INLINE explicit Whole(Lanes::Words words) : v(words) {}
};
// Wraps around at 32 bits, as in shaders.
using Unsigned = uint32_t __attribute__((vector_size(sizeof(Lanes::Words))));
INLINE Whole wrapped(Unsigned words) { return Whole(reinterpret_cast<Lanes::Words>(words)); }
INLINE Unsigned unsigned_of(Whole a) { return reinterpret_cast<Unsigned>(a.v); }
INLINE Whole operator+(Whole a, Whole b) { return wrapped(unsigned_of(a) + unsigned_of(b)); }
INLINE Whole operator-(Whole a, Whole b) { return wrapped(unsigned_of(a) - unsigned_of(b)); }
INLINE Whole operator*(Whole a, Whole b) { return wrapped(unsigned_of(a) * unsigned_of(b)); }
INLINE Whole operator&(Whole a, Whole b) { return Whole(a.v & b.v); }
INLINE Whole operator|(Whole a, Whole b) { return Whole(a.v | b.v); }
INLINE Whole operator^(Whole a, Whole b) { return Whole(a.v ^ b.v); }
INLINE Whole operator~(Whole a) { return Whole(~a.v); }
INLINE Whole operator<<(Whole a, int by) { return Whole(a.v << by); }
INLINE Whole operator>>(Whole a, int by) { return Whole(a.v >> by); }  // keeps the sign
INLINE Mask operator<(Whole a, Whole b) { return {Lanes::less(a.v, b.v)}; }
INLINE Mask operator>(Whole a, Whole b) { return b < a; }
INLINE Mask operator==(Whole a, Whole b) { return {Lanes::equal(a.v, b.v)}; }

// Each lane has a float.
struct Real {
    Lanes::V v;
    Real() = default;
    INLINE Real(float all) : v(Lanes::set(all)) {}
    INLINE explicit Real(Lanes::V lanes) : v(lanes) {}
    INLINE explicit Real(Whole w) : v(__builtin_convertvector(w.v, Lanes::V)) {}
};
INLINE Real operator+(Real a, Real b) { return Real(a.v + b.v); }
INLINE Real operator-(Real a, Real b) { return Real(a.v - b.v); }
INLINE Real operator*(Real a, Real b) { return Real(a.v * b.v); }
INLINE Real operator/(Real a, Real b) { return Real(a.v / b.v); }
INLINE Real operator-(Real a) { return Real(-a.v); }
INLINE Real& operator+=(Real& a, Real b) { return a = a + b; }
INLINE Real& operator-=(Real& a, Real b) { return a = a - b; }
INLINE Real& operator*=(Real& a, Real b) { return a = a * b; }
// a * b + c, rounded once if the instruction set has such an operation (SSE2 has not). In plain expressions the
// compiler chooses which products to fuse, and may choose differently wherever it inlines the same code.
INLINE Real multiply_add(Real a, Real b, Real c) { return Real(Lanes::multiply_add(a.v, b.v, c.v)); }
INLINE float multiply_add(float a, float b, float c) { return Lanes::multiply_add(a, b, c); }
INLINE Mask operator<(Real a, Real b) { return {Lanes::less(a.v, b.v)}; }
INLINE Mask operator>(Real a, Real b) { return b < a; }
INLINE Mask operator<=(Real a, Real b) { return {Lanes::less_equal(a.v, b.v)}; }
INLINE Mask operator>=(Real a, Real b) { return b <= a; }
INLINE Mask operator==(Real a, Real b) { return {Lanes::equal(a.v, b.v)}; }
INLINE Mask operator!=(Real a, Real b) { return ~(a == b); }

INLINE Whole bits_of(Real a) { return Whole(reinterpret_cast<Lanes::Words>(a.v)); }
INLINE Real from_bits(Whole a) { return Real(reinterpret_cast<Lanes::V>(a.v)); }
INLINE Whole truncated(Real a) { return Whole(__builtin_convertvector(a.v, Lanes::Words)); }
INLINE uint32_t unsigned_lane(Whole a, int lane) { return static_cast<uint32_t>(a.v[lane]); }

INLINE Real choose(Mask m, Real yes, Real no) { return Real(Lanes::select(m.m, yes.v, no.v)); }
INLINE Whole choose(Mask m, Whole yes, Whole no) { return bits_of(choose(m, from_bits(yes), from_bits(no))); }

// Returns the second operand if either is NaN.
INLINE Real min(Real a, Real b) { return Real(Lanes::min(a.v, b.v)); }
INLINE Real max(Real a, Real b) { return Real(Lanes::max(a.v, b.v)); }
INLINE Whole min(Whole a, Whole b) { return choose(a < b, a, b); }
INLINE Whole max(Whole a, Whole b) { return choose(b < a, a, b); }
INLINE Real clamp(Real a, Real low, Real high) { return min(max(a, low), high); }
INLINE Whole clamp(Whole a, Whole low, Whole high) { return min(max(a, low), high); }
INLINE Real abs(Real a) { return from_bits(bits_of(a) & Whole(0x7FFFFFFF)); }
INLINE Real floor(Real a) { return Real(Lanes::floor(a.v)); }
INLINE Real round(Real a) { return Real(Lanes::round(a.v)); }  // to the nearest, ties to even
INLINE Real fract(Real a) { return a - floor(a); }
INLINE Real sqrt(Real a) { return Real(Lanes::sqrt(a.v)); }
INLINE Real inversesqrt(Real a) { return Real(Lanes::inverse_sqrt(a.v)); }
INLINE Real inverse(Real a) { return Real(Lanes::inverse(a.v)); }  // to the last bit or two
INLINE Real mix(Real a, Real b, Real part) { return a + part * (b - a); }
INLINE Real smoothstep(Real from, Real to, Real a) {
    const Real part = clamp((a - from) / (to - from), 0, 1);
    return part * part * (3 - 2 * part);
}
// The relative error is within 2e-7 above 2^-126; a least-squares polynomial at Chebyshev points.
INLINE Real exp2(Real a) {
    const Real at = max(min(a, 127.0f), -126.0f), whole = floor(at), part = at - whole;
    Real p = 0.00187757667f;
    p = p * part + 0.00898933970f;
    p = p * part + 0.0558263180f;
    p = p * part + 0.240153617f;
    p = p * part + 0.693153073f;
    p = p * part + 0.999999940f;
    return p * from_bits((truncated(whole) + 127) << 23);
}
INLINE Real exp(Real a) { return exp2(a * 1.44269504f); }

INLINE Real load(const float* p) { return Real(Lanes::load(p)); }  // at a multiple of the vector's size
INLINE Real load_any(const float* p) { return Real(Lanes::load_any(p)); }
INLINE Whole load_any(const uint32_t* p) { return bits_of(load_any(reinterpret_cast<const float*>(p))); }
INLINE void store(float* p, Real a) { Lanes::store(p, a.v); }
INLINE void store_any(float* p, Real a) { Lanes::store_any(p, a.v); }
INLINE void store_any(uint32_t* p, Whole a) { store_any(reinterpret_cast<float*>(p), from_bits(a)); }
INLINE Real gather(const float* p, Whole i) { return Real(Lanes::gather(p, i.v)); }
INLINE Whole gather(const uint32_t* p, Whole i) { return bits_of(gather(reinterpret_cast<const float*>(p), i)); }
// Loads four consecutive floats at each lane's index, the first ones into a. Indices need no alignment. Uses loads, not
// gathers.
INLINE void gather_fours(const float* p, Whole i, Real& a, Real& b, Real& c, Real& d) {
    Lanes::gather_fours(p, i.v, a.v, b.v, c.v, d.v);
}
// Two floats of each lane, side by side.
INLINE void store_pairs(float* p, Real x, Real y) { Lanes::store_pairs(p, x.v, y.v); }
INLINE void gather_pairs(const float* p, const uint32_t* pairs, Real& x, Real& y) {
    Lanes::gather_pairs(p, pairs, x.v, y.v);
}
// 0, 1, 2, …
INLINE Whole lane_numbers() {
    Whole numbers;
    for (int i = 0; i < Lanes::kCount; ++i) numbers.v[i] = i;
    return numbers;
}
INLINE float least(Real a) {
    float found = a.v[0];
    for (int i = 1; i < Lanes::kCount; ++i) found = a.v[i] < found ? a.v[i] : found;
    return found;
}
INLINE float greatest(Real a) { return -least(-a); }

// Loads four floats from each of as many addresses as fill the lanes: `stride` floats apart, each a multiple of 16
// bytes.
INLINE Real load_fours(const float* p, size_t stride) { return Real(Lanes::fours(p, stride)); }
INLINE void store_fours(float* p, size_t stride, Real a) { Lanes::store_fours(p, stride, a.v); }

// Four floats, whatever the number of lanes: a column, or a vertex.
using Four = float __attribute__((vector_size(16), may_alias));
INLINE Four load_four(const float* p) { return *reinterpret_cast<const Four*>(p); }
INLINE void store_four(float* p, Four v) { *reinterpret_cast<Four*>(p) = v; }
INLINE Four load_any_four(const float* p) {
    Four v;
    __builtin_memcpy(&v, p, sizeof v);
    return v;
}
INLINE void store_any_four(float* p, Four v) { __builtin_memcpy(p, &v, sizeof v); }

}  // namespace
