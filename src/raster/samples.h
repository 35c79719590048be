// Samples of pixels, and what is written of them: the nearest triangle, or the height of a shadow map.
#pragma once

#include "raster/frame.h"
#include "raster/lane_types.h"

namespace throng::raster {
namespace {

enum class Into { kMap, kPicture1, kPicture4 };

// Where the samples of a pixel lie, in subpixels: Vulkan's standard places.
template <Into kInto>
struct Pattern {
    static constexpr int kCount = 1, kFirst = 128, kLast = 128;  // the least and the greatest of them
    static constexpr float kX[1]{128}, kY[1]{128};
};
template <>
struct Pattern<Into::kPicture4> {
    static constexpr int kCount = 4, kFirst = 32, kLast = 224;
    static constexpr float kX[4]{96, 224, 32, 160}, kY[4]{32, 96, 160, 224};
};

// A block of 16 samples that are tested at a time: 4 x 4 pixels of one, or 2 x 2 of four, row by row.
template <Into kInto>
struct SampleBlock {
    static constexpr int kSide = kInto == Into::kPicture4 ? 2 : 4;  // pixels
    static constexpr int kVectors = 16 / Lanes::kCount;

    struct Places {
        alignas(64) float x[16], y[16];
    };
    static constexpr Places places() {
        Places at{};
        for (int i = 0; i < 16; ++i) {
            const int pixel = i / Pattern<kInto>::kCount, sample = i % Pattern<kInto>::kCount;
            at.x[i] = Pattern<kInto>::kX[sample] + static_cast<float>(256 * (pixel % kSide));
            at.y[i] = Pattern<kInto>::kY[sample] + static_cast<float>(256 * (pixel / kSide));
        }
        return at;
    }
    static constexpr Places kPlaces = places();
    static INLINE Real x(int vector) { return load(kPlaces.x + vector * Lanes::kCount); }
    static INLINE Real y(int vector) { return load(kPlaces.y + vector * Lanes::kCount); }

    // Mask of the samples in the first `width` columns and `height` rows of pixels.
    static INLINE uint32_t within(int width, int height) {
        static constexpr uint32_t kColumns4[]{0x1111, 0x3333, 0x7777, 0xFFFF}, kRows4[]{0xF, 0xFF, 0xFFF, 0xFFFF},
            kColumns2[]{0x0F0F, 0xFFFF}, kRows2[]{0x00FF, 0xFFFF};
        const int w = (width < kSide ? width : kSide) - 1, h = (height < kSide ? height : kSide) - 1;
        if constexpr (kSide == 4) return kColumns4[w] & kRows4[h];
        return kColumns2[w & 1] & kRows2[h & 1];
    }
};

// The depth, or height, of a triangle over the subpixels from its first corner. All compute it by the same expression,
// so that a sample's depth depends on no tile or block.
struct Plane {
    float x0, y0, z0;  // x0, y0: subpixels
    float per_x, per_y;
    float most;  // at its corners
    // Lowers it by its slope times 1.5 texels, as the pipeline's depth bias does: a triangle shall not shadow itself
    // between the texels of a shadow map
    INLINE void bias() {
        const float x = per_x < 0 ? -per_x : per_x, y = per_y < 0 ? -per_y : per_y;
        const float way = 1.5f * 256 * (x < y ? y : x);
        z0 -= way;
        most -= way;
    }
    // At least kLeast: 0 means empty, and bits of numbers below 0 do not compare as integers.
    INLINE Real at(Real x, Real y) const { return max(min(per_x * (x - x0) + (per_y * (y - y0) + z0), most), kLeast); }
    INLINE float at(float x, float y) const {
        const float z = per_x * (x - x0) + (per_y * (y - y0) + z0), low = z < most ? z : most;
        return low > kLeast ? low : kLeast;
    }

private:
    static constexpr float kLeast = 0x1p-126f;
};

INLINE uint64_t sample_of(float depth, uint32_t id) {
    return uint64_t{__builtin_bit_cast(uint32_t, depth)} << 32 | static_cast<uint32_t>(~id);
}
INLINE void raise(uint64_t& sample, uint64_t to) {
    if (sample < to) sample = to;
}
INLINE void raise(float& height, float to) {
    if (height < to) height = to;
}

// Four floats, all bits of those that a mask names.
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

// Four neighbouring texels, of which the bits of `mask` say which.
INLINE void raise_heights(float* heights, uint32_t mask, const float* to) {
    using Bits = int32_t __attribute__((vector_size(16), may_alias));
    const Four before = load_any_four(heights);
    const auto there = reinterpret_cast<Four>(*reinterpret_cast<const Bits*>(to) &
                                              *reinterpret_cast<const Bits*>(kFourOf.of[mask]));
    store_any_four(heights, there > before ? there : before);  // heights are at least 0
}

// Four samples side by side, of which the bits of `mask` say which.
INLINE void raise_four(uint64_t* samples, uint32_t mask, const float* depths, uint32_t id) {
#if defined(__AVX2__)
    // Numbers of 63 bits: depths are above 0
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

template <Into kInto>
struct Target {
    Target(const Frame& of, const Tile& tile)
        : frame(of),
          columns(kInto == Into::kMap ? of.map_size : of.width),
          first_x(static_cast<int>(tile.x0)),
          end_x(static_cast<int>(tile.x1)) {}

    // One sample of a pixel.
    INLINE void write(int x, int y, uint32_t sample, float depth, uint32_t id) const {
        const ptrdiff_t pixel = y * columns + x;
        if constexpr (kInto == Into::kMap)
            raise(frame.map[pixel], depth);
        else
            raise(frame.samples[pixel * Pattern<kInto>::kCount + static_cast<int>(sample)], sample_of(depth, id));
    }
    // Samples of a block, whose first pixel is at x, y.
    INLINE void write_block(int x, int y, uint32_t mask, const Plane& plane, uint32_t id) const {
        using Of = Pattern<kInto>;
        using Block = SampleBlock<kInto>;
        const auto left = static_cast<float>(256 * x), top = static_cast<float>(256 * y);
        if (Of::kCount == 1 && __builtin_popcount(mask) <= 2) {
            for (uint32_t rest = mask; rest != 0; rest &= rest - 1) {
                const int i = __builtin_ctz(rest);
                write(x + i % 4, y + i / 4, 0, plane.at(left + Block::kPlaces.x[i], top + Block::kPlaces.y[i]), id);
            }
            return;
        }
        alignas(64) float depths[16];
        for (int v = 0; v < Block::kVectors; ++v)
            store(depths + v * Lanes::kCount, plane.at(Block::x(v) + left, Block::y(v) + top));
        if constexpr (kInto == Into::kPicture4) {
            for (int pixel = 0; pixel < 4; ++pixel)
                if (const uint32_t of_pixel = mask >> (4 * pixel) & 0xF)
                    raise_four(frame.samples + ((y + pixel / 2) * columns + x + pixel % 2) * 4, of_pixel,
                               depths + 4 * pixel, id);
        } else if (x >= first_x && x + 4 <= end_x) {
            for (int row = 0; row < 4; ++row)
                if (const uint32_t of_row = mask >> (4 * row) & 0xF) {
                    const ptrdiff_t first = (y + row) * columns + x;
                    if constexpr (kInto == Into::kMap)
                        raise_heights(frame.map + first, of_row, depths + 4 * row);
                    else
                        raise_four(frame.samples + first, of_row, depths + 4 * row, id);
                }
        } else {
            for (uint32_t rest = mask; rest != 0; rest &= rest - 1) {
                const int i = __builtin_ctz(rest);
                write(x + i % 4, y + i / 4, 0, depths[i], id);
            }
        }
    }

    const Frame& frame;
    const ptrdiff_t columns;
    const int first_x, end_x;  // of the tile, outside of which other threads write
};

}  // namespace
}  // namespace throng::raster
