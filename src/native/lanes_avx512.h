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
    static constexpr int kCount = 16;

    static V load(const float* p) { return _mm512_load_ps(p); }
    static void store(float* p, V v) { _mm512_store_ps(p, v); }
    static void stream(float* p, V v) { _mm512_stream_ps(p, v); }
    static V set(float f) { return _mm512_set1_ps(f); }
    static I load_words(const void* p) { return _mm512_load_si512(p); }
    static V bits(I i) { return _mm512_castsi512_ps(i); }

    // Both to the last bit or two: 14 bits, and a step of Newton's.
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
    static V select(Mask m, V yes, V no) { return _mm512_mask_blend_ps(m, no, yes); }

    // 16-bit words of two rows, each pair times a pair of weights.
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
    // In each 128 bits.
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
    // Half floats of both, those of the first below.
    static V halves(V low, V high) {
        const I l = _mm512_cvtepu16_epi32(_mm512_cvtps_ph(low, _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC));
        const I h = _mm512_cvtepu16_epi32(_mm512_cvtps_ph(high, _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC));
        return bits(_mm512_or_si512(l, _mm512_slli_epi32(h, 16)));
    }
    static void fence() { _mm_sfence(); }
};

}  // namespace
