// NEON of 64-bit ARM: four lanes. Stores are plain ones.
#pragma once

#include <arm_neon.h>

#include <cstddef>
#include <cstdint>

namespace {

struct Lanes {
    using V = float32x4_t;
    using I = int16x8_t;
    using Mask = uint32x4_t;
    using Words = int32_t __attribute__((vector_size(16)));
    static constexpr int kCount = 4;

    static V load(const float* p) { return vld1q_f32(p); }
    static void store(float* p, V v) { vst1q_f32(p, v); }
    static void stream(float* p, V v) { vst1q_f32(p, v); }
    static V set(float f) { return vdupq_n_f32(f); }
    static I load_words(const void* p) { return vld1q_s16(static_cast<const int16_t*>(p)); }

    static V inverse_sqrt(V x) {  // 8 bits, then two Newton steps
        V r = vrsqrteq_f32(x);
        r = vmulq_f32(r, vrsqrtsq_f32(vmulq_f32(x, r), r));
        return vmulq_f32(r, vrsqrtsq_f32(vmulq_f32(x, r), r));
    }
    static V inverse(V x) { return vdivq_f32(set(1), x); }
    static V sqrt(V x) { return vsqrtq_f32(x); }
    static V flip_where_negative(V v, V sign) {
        const uint32x4_t bit = vandq_u32(vreinterpretq_u32_f32(sign), vdupq_n_u32(0x80000000u));
        return vreinterpretq_f32_u32(veorq_u32(vreinterpretq_u32_f32(v), bit));
    }
    static Mask less(V a, V b) { return vcltq_f32(a, b); }
    static bool any(Mask m) { return vmaxvq_u32(m) != 0; }
    static V select(Mask m, V yes, V no) { return vbslq_f32(m, yes, no); }

    // Interpolates 16-bit words of two rows: multiplies each pair of words by the pair of weights, and adds the
    // products.
    static I splat(int pair) { return vreinterpretq_s16_s32(vdupq_n_s32(pair)); }
    static V lerp_low(I a, I b, I weights) {
        const int16x4_t w = vget_low_s16(weights);
        return vcvtq_f32_s32(vmlal_lane_s16(vmull_lane_s16(vget_low_s16(a), w, 0), vget_low_s16(b), w, 1));
    }
    static V lerp_high(I a, I b, I weights) {
        const int16x4_t w = vget_low_s16(weights);
        return vcvtq_f32_s32(vmlal_lane_s16(vmull_lane_s16(vget_high_s16(a), w, 0), vget_high_s16(b), w, 1));
    }

    static V fours(const float* p, size_t) { return load(p); }
    static void transpose(V& a, V& b, V& c, V& d) {
        const float32x4x2_t ab = vtrnq_f32(a, b), cd = vtrnq_f32(c, d);
        a = vcombine_f32(vget_low_f32(ab.val[0]), vget_low_f32(cd.val[0]));
        b = vcombine_f32(vget_low_f32(ab.val[1]), vget_low_f32(cd.val[1]));
        c = vcombine_f32(vget_high_f32(ab.val[0]), vget_high_f32(cd.val[0]));
        d = vcombine_f32(vget_high_f32(ab.val[1]), vget_high_f32(cd.val[1]));
    }
    // Half floats of both, `low` in the low 16 bits.
    static V halves(V low, V high) {
        const auto half = [](V v) { return vmovl_u16(vreinterpret_u16_f16(vcvt_f16_f32(v))); };
        return vreinterpretq_f32_u32(vorrq_u32(half(low), vshlq_n_u32(half(high), 16)));
    }
    static void fence() {}

    // Only raster/lane_types.h uses what follows
    static V multiply_add(V a, V b, V c) { return vfmaq_f32(c, a, b); }
    static float multiply_add(float a, float b, float c) { return __builtin_fmaf(a, b, c); }
    static void store_fours(float* p, size_t, V v) { store(p, v); }
    static V load_any(const float* p) { return vld1q_f32(p); }
    static void store_any(float* p, V v) { vst1q_f32(p, v); }
    // As on x86: the second operand if either is NaN
    static V min(V a, V b) { return select(less(a, b), a, b); }
    static V max(V a, V b) { return select(less(b, a), a, b); }
    static V floor(V v) { return vrndmq_f32(v); }
    static V round(V v) { return vrndnq_f32(v); }
    static V gather(const float* p, Words i) { return V{p[i[0]], p[i[1]], p[i[2]], p[i[3]]}; }
    static void store_pairs(float* p, V x, V y) { vst2q_f32(p, {{x, y}}); }
    static void gather_pairs(const float* p, const uint32_t* i, V& x, V& y) {
        const auto two = [p](uint32_t a, uint32_t b) {
            return vcombine_f32(vld1_f32(p + 2 * size_t{a}), vld1_f32(p + 2 * size_t{b}));
        };
        const V first = two(i[0], i[1]), second = two(i[2], i[3]);
        x = vuzp1q_f32(first, second);
        y = vuzp2q_f32(first, second);
    }
    // Loads four floats from each lane's index on. `a` gets the first of each.
    static void gather_fours(const float* p, Words at, V& a, V& b, V& c, V& d) {
        alignas(64) int32_t i[kCount];
        __builtin_memcpy(i, &at, sizeof i);
        a = vld1q_f32(p + i[0]);
        b = vld1q_f32(p + i[1]);
        c = vld1q_f32(p + i[2]);
        d = vld1q_f32(p + i[3]);
        transpose(a, b, c, d);
    }
    static Mask less_equal(V a, V b) { return vcleq_f32(a, b); }
    static Mask equal(V a, V b) { return vceqq_f32(a, b); }
    static Mask less(Words a, Words b) { return reinterpret_cast<Mask>(a < b); }
    static Mask equal(Words a, Words b) { return reinterpret_cast<Mask>(a == b); }
    static Mask both(Mask a, Mask b) { return vandq_u32(a, b); }
    static Mask either(Mask a, Mask b) { return vorrq_u32(a, b); }
    static Mask none_of(Mask a) { return vmvnq_u32(a); }
    static uint32_t bits(Mask m) { return vaddvq_u32(vandq_u32(m, Mask{1, 2, 4, 8})); }
    static Mask mask_of(uint32_t bits) { return vtstq_u32(vdupq_n_u32(bits), Mask{1, 2, 4, 8}); }
};

}  // namespace
