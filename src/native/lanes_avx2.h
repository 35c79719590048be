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
    using Words = int32_t __attribute__((vector_size(32)));
    static constexpr int kCount = 8;

    static V load(const float* p) { return _mm256_load_ps(p); }
    static void store(float* p, V v) { _mm256_store_ps(p, v); }
    static void stream(float* p, V v) { _mm256_stream_ps(p, v); }
    static V set(float f) { return _mm256_set1_ps(f); }
    static I load_words(const void* p) { return _mm256_load_si256(static_cast<const __m256i*>(p)); }

    static V inverse_sqrt(V x) {  // 12 bits, then a Newton step
        const V r = _mm256_rsqrt_ps(x);
        return r * (set(1.5f) - set(0.5f) * x * r * r);
    }
    static V inverse(V x) { return _mm256_div_ps(set(1), x); }
    static V sqrt(V x) { return _mm256_sqrt_ps(x); }
    static V flip_where_negative(V v, V sign) { return _mm256_xor_ps(v, _mm256_and_ps(sign, set(-0.0f))); }
    static Mask less(V a, V b) { return _mm256_cmp_ps(a, b, _CMP_LT_OQ); }
    static bool any(Mask m) { return _mm256_movemask_ps(m) != 0; }
    static V select(Mask m, V yes, V no) { return _mm256_blendv_ps(no, yes, m); }

    // Interpolates 16-bit words of two rows: multiplies each pair of words by the pair of weights, and adds the
    // products.
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
    // Within each 128 bits.
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
    // Half floats of both, `low` in the low 16 bits.
    static V halves(V low, V high) {
        const I l = _mm256_cvtepu16_epi32(_mm256_cvtps_ph(low, _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC));
        const I h = _mm256_cvtepu16_epi32(_mm256_cvtps_ph(high, _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC));
        return _mm256_castsi256_ps(_mm256_or_si256(l, _mm256_slli_epi32(h, 16)));
    }
    static void fence() { _mm_sfence(); }

    // Only raster/lane_types.h uses what follows
    static V multiply_add(V a, V b, V c) { return _mm256_fmadd_ps(a, b, c); }
    static float multiply_add(float a, float b, float c) { return __builtin_fmaf(a, b, c); }
    static void store_fours(float* p, size_t stride, V v) {
        _mm_store_ps(p, _mm256_castps256_ps128(v));
        _mm_store_ps(p + stride, _mm256_extractf128_ps(v, 1));
    }
    static V load_any(const float* p) { return _mm256_loadu_ps(p); }
    static void store_any(float* p, V v) { _mm256_storeu_ps(p, v); }
    static V min(V a, V b) { return _mm256_min_ps(a, b); }
    static V max(V a, V b) { return _mm256_max_ps(a, b); }
    static V floor(V v) { return _mm256_floor_ps(v); }
    static V round(V v) { return _mm256_round_ps(v, _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC); }
    static V gather(const float* p, Words i) { return _mm256_i32gather_ps(p, reinterpret_cast<I>(i), 4); }
    static void store_pairs(float* p, V x, V y) {
        const V low = _mm256_unpacklo_ps(x, y), high = _mm256_unpackhi_ps(x, y);
        store(p, _mm256_permute2f128_ps(low, high, 0x20));
        store(p + 8, _mm256_permute2f128_ps(low, high, 0x31));
    }
    // Loads one by one are faster than gathers of 64 bits on processors with slow gathers.
    static void gather_pairs(const float* p, const uint32_t* i, V& x, V& y) {
        const auto two = [p](uint32_t a, uint32_t b) {
            const auto pair = [p](uint32_t of) { return p + 2 * size_t{of}; };
            const __m128i low = _mm_loadl_epi64(reinterpret_cast<const __m128i*>(pair(a)));
            return _mm_loadh_pi(_mm_castsi128_ps(low), reinterpret_cast<const __m64*>(pair(b)));
        };
        const V first = _mm256_insertf128_ps(_mm256_castps128_ps256(two(i[0], i[1])), two(i[4], i[5]), 1),
                second = _mm256_insertf128_ps(_mm256_castps128_ps256(two(i[2], i[3])), two(i[6], i[7]), 1);
        x = _mm256_shuffle_ps(first, second, _MM_SHUFFLE(2, 0, 2, 0));
        y = _mm256_shuffle_ps(first, second, _MM_SHUFFLE(3, 1, 3, 1));
    }
    // Loads four floats from each lane's index on. `a` gets the first of each.
    static void gather_fours(const float* p, Words at, V& a, V& b, V& c, V& d) {
        alignas(64) int32_t i[kCount];
        __builtin_memcpy(i, &at, sizeof i);
        const auto two = [&](int lane) {
            return _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_loadu_ps(p + i[lane])),
                                        _mm_loadu_ps(p + i[lane + 4]), 1);
        };
        a = two(0);
        b = two(1);
        c = two(2);
        d = two(3);
        transpose(a, b, c, d);
    }
    static Mask less_equal(V a, V b) { return _mm256_cmp_ps(a, b, _CMP_LE_OQ); }
    static Mask equal(V a, V b) { return _mm256_cmp_ps(a, b, _CMP_EQ_OQ); }
    static Mask less(Words a, Words b) { return reinterpret_cast<Mask>(a < b); }
    static Mask equal(Words a, Words b) { return reinterpret_cast<Mask>(a == b); }
    static Mask both(Mask a, Mask b) { return _mm256_and_ps(a, b); }
    static Mask either(Mask a, Mask b) { return _mm256_or_ps(a, b); }
    static Mask none_of(Mask a) { return reinterpret_cast<Mask>(~reinterpret_cast<Words>(a)); }
    static uint32_t bits(Mask m) { return static_cast<uint32_t>(_mm256_movemask_ps(m)); }
    static Mask mask_of(uint32_t bits) {
        const Words bit{1, 2, 4, 8, 16, 32, 64, 128};
        return reinterpret_cast<Mask>((static_cast<int32_t>(bits) & bit) != 0);
    }
};

}  // namespace
