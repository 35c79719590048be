// Raises adjacent samples or heights to greater values: the nearest triangle, the highest point.
#pragma once

#include "raster/lane_types.h"

namespace throng::raster {
namespace {

INLINE uint64_t sample_of(float depth, uint32_t id) {
    return uint64_t{__builtin_bit_cast(uint32_t, depth)} << 32 | static_cast<uint32_t>(~id);
}
INLINE void raise(uint64_t& sample, uint64_t to) {
    if (sample < to) sample = to;
}
INLINE void raise(float& height, float to) {
    if (height < to) height = to;
}

// The bits of `mask` say which of the four heights, or of the four or eight samples, to raise. `to`, `depths`: at a
// multiple of 16 bytes, or of 32 for eight.
#if defined(__AVX512F__)

INLINE void raise_heights(float* heights, uint32_t mask, const float* to) {
    const auto of = static_cast<__mmask8>(mask);
    const __m128 raised = _mm_load_ps(to), before = _mm_maskz_loadu_ps(of, heights);
    _mm_mask_storeu_ps(heights, _mm_mask_cmp_ps_mask(of, raised, before, _CMP_GT_OQ), raised);
}

INLINE void raise_four(uint64_t* samples, uint32_t mask, const float* depths, uint32_t id) {
    const auto of = static_cast<__mmask8>(mask);
    const __m256i high = _mm256_cvtepu32_epi64(_mm_load_si128(reinterpret_cast<const __m128i*>(depths)));
    const __m256i to = _mm256_or_si256(_mm256_slli_epi64(high, 32), _mm256_set1_epi64x(static_cast<uint32_t>(~id)));
    const __m256i before = _mm256_maskz_loadu_epi64(of, samples);
    _mm256_mask_storeu_epi64(samples, _mm256_mask_cmpgt_epu64_mask(of, to, before), to);
}

INLINE void raise_eight(uint64_t* samples, uint32_t mask, const float* depths, uint32_t id) {
    if (mask == 0) return;
    const auto of = static_cast<__mmask8>(mask);
    const __m512i high = _mm512_cvtepu32_epi64(_mm256_load_si256(reinterpret_cast<const __m256i*>(depths)));
    const __m512i to = _mm512_or_si512(_mm512_slli_epi64(high, 32), _mm512_set1_epi64(static_cast<uint32_t>(~id)));
    const __m512i before = _mm512_maskz_loadu_epi64(of, samples);
    _mm512_mask_storeu_epi64(samples, _mm512_mask_cmpgt_epu64_mask(of, to, before), to);
}

#else

// For each mask, four words with all bits set in those that the mask names.
struct FourOf {
    alignas(16) int32_t of[16][4];
};
constexpr FourOf four_of() {
    FourOf all{};
    for (int mask = 0; mask < 16; ++mask)
        for (int i = 0; i < 4; ++i) all.of[mask][i] = (mask >> i & 1) != 0 ? -1 : 0;
    return all;
}
constexpr FourOf kFourOf = four_of();

INLINE void raise_heights(float* heights, uint32_t mask, const float* to) {
    using Bits = int32_t __attribute__((vector_size(16), may_alias));
    const Four before = load_any_four(heights);
    const auto there = reinterpret_cast<Four>(*reinterpret_cast<const Bits*>(to) &
                                              *reinterpret_cast<const Bits*>(kFourOf.of[mask]));
    store_any_four(heights, there > before ? there : before);  // heights are at least 0
}

INLINE void raise_four(uint64_t* samples, uint32_t mask, const float* depths, uint32_t id) {
#if defined(__AVX2__)
    // Samples are numbers of 63 bits, since depths are above 0
    const __m256i bit = _mm256_set_epi64x(8, 4, 2, 1), all = _mm256_set1_epi64x(mask);
    const __m256i high = _mm256_slli_epi64(
        _mm256_cvtepu32_epi64(_mm_load_si128(reinterpret_cast<const __m128i*>(depths))), 32);
    const __m256i to = _mm256_or_si256(high, _mm256_set1_epi64x(static_cast<uint32_t>(~id)));
    const __m256i before = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(samples));
    const __m256i raises = _mm256_and_si256(_mm256_cmpgt_epi64(to, before),
                                            _mm256_cmpeq_epi64(_mm256_and_si256(all, bit), bit));
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(samples), _mm256_blendv_epi8(before, to, raises));
#else
    for (uint32_t rest = mask; rest != 0; rest &= rest - 1) {
        const int i = __builtin_ctz(rest);
        raise(samples[i], sample_of(depths[i], id));
    }
#endif
}

INLINE void raise_eight(uint64_t* samples, uint32_t mask, const float* depths, uint32_t id) {
    if ((mask & 0xF) != 0) raise_four(samples, mask & 0xF, depths, id);
    if (mask >> 4 != 0) raise_four(samples + 4, mask >> 4, depths + 4, id);
}

#endif

}  // namespace
}  // namespace throng::raster
