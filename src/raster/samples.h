// Samples of pixels, and what is written to them: the nearest triangle, or the height of a shadow map.
#pragma once

#include "raster/frame.h"
#include "raster/lane_types.h"
#include "raster/raise.h"

namespace throng::raster {
namespace {

enum class Into { kMap, kPicture1, kPicture4 };

// Where the samples of a pixel lie, in subpixels: Vulkan's standard sample locations.
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

// A block of 16 samples that are tested together: 4 x 4 pixels of one sample, or 2 x 2 of four, row by row.
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

INLINE float lesser(float a, float b) { return a < b ? a : b; }
INLINE Real lesser(Real a, Real b) { return min(a, b); }
INLINE float greater(float a, float b) { return a > b ? a : b; }
INLINE Real greater(Real a, Real b) { return max(a, b); }
INLINE float magnitude(float a) { return __builtin_fabsf(a); }
INLINE Real magnitude(Real a) { return abs(a); }

// The depths, or heights, of one triangle, or of one triangle in each lane. All depths come from these expressions,
// whose rounding is not left to the compiler. So a sample's depth does not depend on its tile, block or material.
template <class Number>
struct Plane {
    // Depths are at least this: 0 means empty, and bits of numbers below 0 do not compare as integers.
    static constexpr float kMinDepth = 0x1p-126f;

    Number x0, y0, z0;  // of the first corner; x0, y0: subpixels
    Number per_x, per_y;
    Number most;  // at its corners

    // x, y: subpixels, of one place or as many as there are lanes.
    template <class Place>
    INLINE Place at(Place x, Place y) const {
        const Place of_row = multiply_add(per_y, y - y0, z0);
        return greater(lesser(multiply_add(per_x, x - x0, of_row), most), kMinDepth);
    }
};

// Corners 1 and 2 relative to the first one, in subpixels.
template <class Number>
struct Sides {
    Number x1, y1, x2, y2;
};

// In a shadow map triangles are lowered by 1.5 texels of their slope, like the pipeline's depth bias, so that none
// shadows itself between the texels.
template <Into kInto, class Number>
INLINE Plane<Number> plane_of(Number x0, Number y0, const Sides<Number>& sides, const Number (&z)[3], Number per_area) {
    const Number z1 = z[1] - z[0], z2 = z[2] - z[0], most = greater(greater(z[1], z[2]), z[0]);
    const Number per_x = multiply_add(z1, sides.y2, -(z2 * sides.y1)) * per_area,
                 per_y = multiply_add(z2, sides.x1, -(z1 * sides.x2)) * per_area;
    const auto lowered = [&](Number height) {
        return multiply_add(greater(magnitude(per_x), magnitude(per_y)), -1.5f * 256, height);
    };
    if constexpr (kInto == Into::kMap) return {x0, y0, lowered(z[0]), per_x, per_y, lowered(most)};
    return {x0, y0, z[0], per_x, per_y, most};
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
    INLINE void write_block(int x, int y, uint32_t mask, const Plane<float>& plane, uint32_t id) const {
        using Of = Pattern<kInto>;
        using Block = SampleBlock<kInto>;
        const auto left = static_cast<float>(256 * x), top = static_cast<float>(256 * y);
        if (Of::kCount == 1 && __builtin_popcount(mask) <= 1) {
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
            for (int row = 0; row < 2; ++row)
                raise_eight(frame.samples + ((y + row) * columns + x) * 4, mask >> (8 * row) & 0xFF, depths + 8 * row,
                            id);
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
