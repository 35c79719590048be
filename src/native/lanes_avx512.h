// AVX-512 (F, BW, DQ, VL): sixteen lanes.
#pragma once

#include <immintrin.h>

#include <cstddef>
#include <cstdint>

namespace {

struct Lanes {
    using V = __m512;
    using I = __m512i;
    using Mask = __mmask16;
    using Words = int32_t __attribute__((vector_size(64)));
    static constexpr int kCount = 16;

    static V load(const float* p) { return _mm512_load_ps(p); }
    static void store(float* p, V v) { _mm512_store_ps(p, v); }
    static void stream(float* p, V v) { _mm512_stream_ps(p, v); }
    static V set(float f) { return _mm512_set1_ps(f); }
    static I load_words(const void* p) { return _mm512_load_si512(p); }
    static V bits(I i) { return _mm512_castsi512_ps(i); }

    // Both are exact to the last bit or two: 14 bits, then a Newton step.
    static V inverse_sqrt(V x) {
        const V r = _mm512_rsqrt14_ps(x);
        return r * (set(1.5f) - set(0.5f) * x * r * r);
    }
    static V inverse(V x) {
        const V r = _mm512_rcp14_ps(x);
        return r * (set(2) - x * r);
    }
    static V sqrt(V x) { return _mm512_sqrt_ps(x); }
    static V flip_where_negative(V v, V sign) { return _mm512_xor_ps(v, _mm512_and_ps(sign, set(-0.0f))); }
    static Mask less(V a, V b) { return _mm512_cmp_ps_mask(a, b, _CMP_LT_OQ); }
    static bool any(Mask m) { return m != 0; }
    static V select(Mask m, V yes, V no) { return _mm512_mask_blend_ps(m, no, yes); }

    // Interpolates 16-bit words of two rows: multiplies each pair of words by the pair of weights, and adds the
    // products.
    static I splat(int pair) { return _mm512_set1_epi32(pair); }
    static V lerp_low(I a, I b, I weights) {
        return _mm512_cvtepi32_ps(_mm512_madd_epi16(_mm512_unpacklo_epi16(a, b), weights));
    }
    static V lerp_high(I a, I b, I weights) {
        return _mm512_cvtepi32_ps(_mm512_madd_epi16(_mm512_unpackhi_epi16(a, b), weights));
    }

    // Four floats from each of kCount / 4 places.
    static V fours(const float* p, size_t stride) {
        V v = _mm512_castps128_ps512(_mm_load_ps(p));
        v = _mm512_insertf32x4(v, _mm_load_ps(p + stride), 1);
        v = _mm512_insertf32x4(v, _mm_load_ps(p + 2 * stride), 2);
        return _mm512_insertf32x4(v, _mm_load_ps(p + 3 * stride), 3);
    }
    // Within each 128 bits.
    static void transpose(V& a, V& b, V& c, V& d) {
        const __m512d ab0 = _mm512_castps_pd(_mm512_unpacklo_ps(a, b)),
                      ab1 = _mm512_castps_pd(_mm512_unpackhi_ps(a, b));
        const __m512d cd0 = _mm512_castps_pd(_mm512_unpacklo_ps(c, d)),
                      cd1 = _mm512_castps_pd(_mm512_unpackhi_ps(c, d));
        a = _mm512_castpd_ps(_mm512_unpacklo_pd(ab0, cd0));
        b = _mm512_castpd_ps(_mm512_unpackhi_pd(ab0, cd0));
        c = _mm512_castpd_ps(_mm512_unpacklo_pd(ab1, cd1));
        d = _mm512_castpd_ps(_mm512_unpackhi_pd(ab1, cd1));
    }
    // Half floats of both, `low` in the low 16 bits.
    static V halves(V low, V high) {
        const I l = _mm512_cvtepu16_epi32(_mm512_cvtps_ph(low, _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC));
        const I h = _mm512_cvtepu16_epi32(_mm512_cvtps_ph(high, _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC));
        return bits(_mm512_or_si512(l, _mm512_slli_epi32(h, 16)));
    }
    static void fence() { _mm_sfence(); }

    // Only raster/lane_types.h uses what follows
    static V multiply_add(V a, V b, V c) { return _mm512_fmadd_ps(a, b, c); }
    static float multiply_add(float a, float b, float c) { return __builtin_fmaf(a, b, c); }
    static void store_fours(float* p, size_t stride, V v) {
        _mm_store_ps(p, _mm512_castps512_ps128(v));
        _mm_store_ps(p + stride, _mm512_extractf32x4_ps(v, 1));
        _mm_store_ps(p + 2 * stride, _mm512_extractf32x4_ps(v, 2));
        _mm_store_ps(p + 3 * stride, _mm512_extractf32x4_ps(v, 3));
    }
    static V load_any(const float* p) { return _mm512_loadu_ps(p); }
    static void store_any(float* p, V v) { _mm512_storeu_ps(p, v); }
    static V min(V a, V b) { return _mm512_min_ps(a, b); }
    static V max(V a, V b) { return _mm512_max_ps(a, b); }
    static V floor(V v) { return _mm512_roundscale_ps(v, _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC); }
    static V round(V v) { return _mm512_roundscale_ps(v, _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC); }
    static V gather(const float* p, Words i) { return _mm512_i32gather_ps(reinterpret_cast<I>(i), p, 4); }
    static void store_pairs(float* p, V x, V y) {
        const I low = _mm512_set_epi32(23, 7, 22, 6, 21, 5, 20, 4, 19, 3, 18, 2, 17, 1, 16, 0),
                high = _mm512_set_epi32(31, 15, 30, 14, 29, 13, 28, 12, 27, 11, 26, 10, 25, 9, 24, 8);
        store(p, _mm512_permutex2var_ps(x, low, y));
        store(p + 16, _mm512_permutex2var_ps(x, high, y));
    }
    static void gather_pairs(const float* p, const uint32_t* i, V& x, V& y) {
        const auto eight = [p](const uint32_t* of) {
            return _mm512_castpd_ps(
                _mm512_i32gather_pd(_mm256_loadu_si256(reinterpret_cast<const __m256i*>(of)), p, 8));
        };
        const V first = eight(i), second = eight(i + 8);
        const I even = _mm512_set_epi32(30, 28, 26, 24, 22, 20, 18, 16, 14, 12, 10, 8, 6, 4, 2, 0),
                odd = _mm512_set_epi32(31, 29, 27, 25, 23, 21, 19, 17, 15, 13, 11, 9, 7, 5, 3, 1);
        x = _mm512_permutex2var_ps(first, even, second);
        y = _mm512_permutex2var_ps(first, odd, second);
    }
    // Loads four floats from each lane's index on. `a` gets the first of each.
    static void gather_fours(const float* p, Words at, V& a, V& b, V& c, V& d) {
        alignas(64) int32_t i[kCount];
        __builtin_memcpy(i, &at, sizeof i);
        const auto four = [&](int lane) {
            V v = _mm512_castps128_ps512(_mm_loadu_ps(p + i[lane]));
            v = _mm512_insertf32x4(v, _mm_loadu_ps(p + i[lane + 4]), 1);
            v = _mm512_insertf32x4(v, _mm_loadu_ps(p + i[lane + 8]), 2);
            return _mm512_insertf32x4(v, _mm_loadu_ps(p + i[lane + 12]), 3);
        };
        a = four(0);
        b = four(1);
        c = four(2);
        d = four(3);
        transpose(a, b, c, d);
    }
    static Mask less_equal(V a, V b) { return _mm512_cmp_ps_mask(a, b, _CMP_LE_OQ); }
    static Mask equal(V a, V b) { return _mm512_cmp_ps_mask(a, b, _CMP_EQ_OQ); }
    static Mask less(Words a, Words b) {
        return _mm512_cmplt_epi32_mask(reinterpret_cast<I>(a), reinterpret_cast<I>(b));
    }
    static Mask equal(Words a, Words b) {
        return _mm512_cmpeq_epi32_mask(reinterpret_cast<I>(a), reinterpret_cast<I>(b));
    }
    static Mask both(Mask a, Mask b) { return _kand_mask16(a, b); }
    static Mask either(Mask a, Mask b) { return _kor_mask16(a, b); }
    static Mask none_of(Mask a) { return _knot_mask16(a); }
    static uint32_t bits(Mask m) { return m; }
    static Mask mask_of(uint32_t bits) { return static_cast<Mask>(bits); }
};

}  // namespace
