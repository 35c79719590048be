// AVX2, FMA and F16C: eight lanes.
#pragma once

#include <immintrin.h>

#include <cstddef>
#include <cstdint>

namespace {

struct Lanes {
    using V = __m256;
    using I = __m256i;
    using Mask = __m256;
    static constexpr int kCount = 8;

    static V load(const float* p) { return _mm256_load_ps(p); }
    static void store(float* p, V v) { _mm256_store_ps(p, v); }
    static void stream(float* p, V v) { _mm256_stream_ps(p, v); }
    static V set(float f) { return _mm256_set1_ps(f); }
    static I load_words(const void* p) { return _mm256_load_si256(static_cast<const __m256i*>(p)); }

    static V inverse_sqrt(V x) {  // 12 bits, and a step of Newton's
        const V r = _mm256_rsqrt_ps(x);
        return r * (set(1.5f) - set(0.5f) * x * r * r);
    }
    static V inverse(V x) { return _mm256_div_ps(set(1), x); }
    static V sqrt(V x) { return _mm256_sqrt_ps(x); }
    static V flip_where_negative(V v, V sign) { return _mm256_xor_ps(v, _mm256_and_ps(sign, set(-0.0f))); }
    static Mask less(V a, V b) { return _mm256_cmp_ps(a, b, _CMP_LT_OQ); }
    static V select(Mask m, V yes, V no) { return _mm256_blendv_ps(no, yes, m); }

    // 16-bit words of two rows, each pair times a pair of weights.
    static I splat(int pair) { return _mm256_set1_epi32(pair); }
    static V lerp_low(I a, I b, I weights) {
        return _mm256_cvtepi32_ps(_mm256_madd_epi16(_mm256_unpacklo_epi16(a, b), weights));
    }
    static V lerp_high(I a, I b, I weights) {
        return _mm256_cvtepi32_ps(_mm256_madd_epi16(_mm256_unpackhi_epi16(a, b), weights));
    }

    // Four floats from each of kCount / 4 places.
    static V fours(const float* p, size_t stride) {
        return _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_load_ps(p)), _mm_load_ps(p + stride), 1);
    }
    // In each 128 bits.
    static void transpose(V& a, V& b, V& c, V& d) {
        const __m256d ab0 = _mm256_castps_pd(_mm256_unpacklo_ps(a, b)),
                      ab1 = _mm256_castps_pd(_mm256_unpackhi_ps(a, b));
        const __m256d cd0 = _mm256_castps_pd(_mm256_unpacklo_ps(c, d)),
                      cd1 = _mm256_castps_pd(_mm256_unpackhi_ps(c, d));
        a = _mm256_castpd_ps(_mm256_unpacklo_pd(ab0, cd0));
        b = _mm256_castpd_ps(_mm256_unpackhi_pd(ab0, cd0));
        c = _mm256_castpd_ps(_mm256_unpacklo_pd(ab1, cd1));
        d = _mm256_castpd_ps(_mm256_unpackhi_pd(ab1, cd1));
    }
    // Half floats of both, those of the first below.
    static V halves(V low, V high) {
        const I l = _mm256_cvtepu16_epi32(_mm256_cvtps_ph(low, _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC));
        const I h = _mm256_cvtepu16_epi32(_mm256_cvtps_ph(high, _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC));
        return _mm256_castsi256_ps(_mm256_or_si256(l, _mm256_slli_epi32(h, 16)));
    }
    static void fence() { _mm_sfence(); }
};

}  // namespace
