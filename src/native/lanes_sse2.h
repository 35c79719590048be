// SSE2, which every x86-64 has: four lanes.
#pragma once

#include <emmintrin.h>

#include <cstddef>
#include <cstdint>

namespace {

struct Lanes {
    using V = __m128;
    using I = __m128i;
    using Mask = __m128;
    using Words = int32_t __attribute__((vector_size(16)));
    static constexpr int kCount = 4;

    static V load(const float* p) { return _mm_load_ps(p); }
    static void store(float* p, V v) { _mm_store_ps(p, v); }
    static void stream(float* p, V v) { _mm_stream_ps(p, v); }
    static V set(float f) { return _mm_set1_ps(f); }
    static I load_words(const void* p) { return _mm_load_si128(static_cast<const __m128i*>(p)); }

    static V inverse_sqrt(V x) {  // 12 bits, then a Newton step
        const V r = _mm_rsqrt_ps(x);
        return r * (set(1.5f) - set(0.5f) * x * r * r);
    }
    static V inverse(V x) { return _mm_div_ps(set(1), x); }
    static V sqrt(V x) { return _mm_sqrt_ps(x); }
    static V flip_where_negative(V v, V sign) { return _mm_xor_ps(v, _mm_and_ps(sign, set(-0.0f))); }
    static Mask less(V a, V b) { return _mm_cmplt_ps(a, b); }
    static bool any(Mask m) { return _mm_movemask_ps(m) != 0; }
    static V select(Mask m, V yes, V no) { return _mm_or_ps(_mm_and_ps(m, yes), _mm_andnot_ps(m, no)); }

    // Interpolates 16-bit words of two rows: multiplies each pair of words by the pair of weights, and adds the
    // products.
    static I splat(int pair) { return _mm_set1_epi32(pair); }
    static V lerp_low(I a, I b, I weights) {
        return _mm_cvtepi32_ps(_mm_madd_epi16(_mm_unpacklo_epi16(a, b), weights));
    }
    static V lerp_high(I a, I b, I weights) {
        return _mm_cvtepi32_ps(_mm_madd_epi16(_mm_unpackhi_epi16(a, b), weights));
    }

    static V fours(const float* p, size_t) { return _mm_load_ps(p); }
    static void transpose(V& a, V& b, V& c, V& d) { _MM_TRANSPOSE4_PS(a, b, c, d); }

    // Half floats of both, `low` in the low 16 bits; to the nearest, ties to even. Source: F. Giesen,
    // float_to_half_fast3_rtne, https://gist.github.com/rygorous/2156668: small ones are rounded by adding a number
    // whose last bit has the value of a half's last bit.
    static I half(V v) {
        const I sign = _mm_and_si128(_mm_castps_si128(v), _mm_set1_epi32(static_cast<int>(0x80000000u)));
        const V magnitude = _mm_xor_ps(v, _mm_castsi128_ps(sign));
        const I f = _mm_castps_si128(magnitude);
        const I is_small = _mm_cmplt_epi32(f, _mm_set1_epi32(113 << 23));
        const I is_large = _mm_cmpgt_epi32(f, _mm_set1_epi32((143 << 23) - 1));
        const I is_nan = _mm_castps_si128(_mm_cmpunord_ps(v, v));
        const I magic = _mm_set1_epi32(126 << 23);
        const I small = _mm_sub_epi32(_mm_castps_si128(_mm_add_ps(magnitude, _mm_castsi128_ps(magic))), magic);
        const I odd = _mm_and_si128(_mm_srli_epi32(f, 13), _mm_set1_epi32(1));
        const I rounded = _mm_add_epi32(_mm_add_epi32(f, _mm_set1_epi32((15 - 127) * (1 << 23) + 0xFFF)), odd);
        const I large = _mm_or_si128(_mm_set1_epi32(0x7C00), _mm_and_si128(is_nan, _mm_set1_epi32(0x200)));
        const auto choose = [](I mask, I yes, I no) {
            return _mm_or_si128(_mm_and_si128(mask, yes), _mm_andnot_si128(mask, no));
        };
        const I normal = choose(is_small, small, _mm_srli_epi32(rounded, 13));
        return _mm_or_si128(choose(is_large, large, normal), _mm_srli_epi32(sign, 16));
    }
    static V halves(V low, V high) { return _mm_castsi128_ps(_mm_or_si128(half(low), _mm_slli_epi32(half(high), 16))); }
    static void fence() { _mm_sfence(); }

    // Only raster/lane_types.h uses what follows
    static V multiply_add(V a, V b, V c) { return a * b + c; }
    static float multiply_add(float a, float b, float c) { return a * b + c; }
    static void store_fours(float* p, size_t, V v) { store(p, v); }
    static V load_any(const float* p) { return _mm_loadu_ps(p); }
    static void store_any(float* p, V v) { _mm_storeu_ps(p, v); }
    static V min(V a, V b) { return _mm_min_ps(a, b); }
    static V max(V a, V b) { return _mm_max_ps(a, b); }
    // `rounded` where |v| is below 2^23, which 32 bits hold; larger numbers have no fraction.
    static V whole(V v, V rounded) { return select(less(_mm_andnot_ps(set(-0.0f), v), set(0x1p23f)), rounded, v); }
    static V floor(V v) {
        const V cut = _mm_cvtepi32_ps(_mm_cvttps_epi32(v));
        return whole(v, cut - _mm_and_ps(_mm_cmpgt_ps(cut, v), set(1)));
    }
    static V round(V v) { return whole(v, _mm_cvtepi32_ps(_mm_cvtps_epi32(v))); }
    static V gather(const float* p, Words i) { return V{p[i[0]], p[i[1]], p[i[2]], p[i[3]]}; }
    static void store_pairs(float* p, V x, V y) {
        store(p, _mm_unpacklo_ps(x, y));
        store(p + 4, _mm_unpackhi_ps(x, y));
    }
    static void gather_pairs(const float* p, const uint32_t* i, V& x, V& y) {
        const auto two = [p](uint32_t a, uint32_t b) {
            const auto pair = [p](uint32_t of) { return p + 2 * size_t{of}; };
            const __m128i low = _mm_loadl_epi64(reinterpret_cast<const __m128i*>(pair(a)));
            return _mm_loadh_pi(_mm_castsi128_ps(low), reinterpret_cast<const __m64*>(pair(b)));
        };
        const V first = two(i[0], i[1]), second = two(i[2], i[3]);
        x = _mm_shuffle_ps(first, second, _MM_SHUFFLE(2, 0, 2, 0));
        y = _mm_shuffle_ps(first, second, _MM_SHUFFLE(3, 1, 3, 1));
    }
    // Loads four floats from each lane's index on. `a` gets the first of each.
    static void gather_fours(const float* p, Words at, V& a, V& b, V& c, V& d) {
        alignas(64) int32_t i[kCount];
        __builtin_memcpy(i, &at, sizeof i);
        a = _mm_loadu_ps(p + i[0]);
        b = _mm_loadu_ps(p + i[1]);
        c = _mm_loadu_ps(p + i[2]);
        d = _mm_loadu_ps(p + i[3]);
        transpose(a, b, c, d);
    }
    static Mask less_equal(V a, V b) { return _mm_cmple_ps(a, b); }
    static Mask equal(V a, V b) { return _mm_cmpeq_ps(a, b); }
    static Mask less(Words a, Words b) { return reinterpret_cast<Mask>(a < b); }
    static Mask equal(Words a, Words b) { return reinterpret_cast<Mask>(a == b); }
    static Mask both(Mask a, Mask b) { return _mm_and_ps(a, b); }
    static Mask either(Mask a, Mask b) { return _mm_or_ps(a, b); }
    static Mask none_of(Mask a) { return reinterpret_cast<Mask>(~reinterpret_cast<Words>(a)); }
    static uint32_t bits(Mask m) { return static_cast<uint32_t>(_mm_movemask_ps(m)); }
    static Mask mask_of(uint32_t bits) {
        const Words bit{1, 2, 4, 8};
        return reinterpret_cast<Mask>((static_cast<int32_t>(bits) & bit) != 0);
    }
};

}  // namespace
