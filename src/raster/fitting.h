// Triangles of a few pixels, whose edges floats compute exactly: as many at a time as there are lanes.
#pragma once

#include "raster/project.h"
#include "raster/samples.h"

namespace throng::raster {
namespace {

// Pixels, the last ones included.
struct PixelBox {
    Real x0, y0, x1, y1;
};

// An edge function: at least 0 inside, for samples at subpixels x, y from the first pixel of the triangle's box.
// Samples on the edge belong to the triangle if it is a top or a left edge.
struct LaneEdge {
    Real per_x, per_y, at;
    INLINE LaneEdge(Real x0, Real y0, Real x1, Real y1, Real side, Real left, Real top) {
        per_x = (y0 - y1) * side;
        per_y = (x1 - x0) * side;
        const Mask is_top_or_left = (per_x > 0) | ((per_x == 0) & (per_y > 0));
        at = per_x * (left - x0) + per_y * (top - y0) - choose(is_top_or_left, 0.0f, 1.0f);
    }
    INLINE Real operator()(float x, float y) const { return at + (per_x * x + per_y * y); }
};

// In each lane, the samples of the block at the box's first pixel that lie in the triangle and in the tile, as bits.
template <Into kInto>
INLINE Whole samples_of_block(const LaneEdge (&edges)[3], const PixelBox& box, const Tile& tile, Mask live) {
    using Of = Pattern<kInto>;
    constexpr int kSide = SampleBlock<kInto>::kSide;
    const auto left = static_cast<float>(tile.x0), top = static_cast<float>(tile.y0),
               right = static_cast<float>(tile.x1 - 1), bottom = static_cast<float>(tile.y1 - 1);
    const Real last_x = min(box.x1, right), last_y = min(box.y1, bottom);
    Whole samples = 0;
    for (int row = 0; row < kSide; ++row) {
        const Real y = box.y0 + static_cast<float>(row);
        const Mask has_row = live & (y >= top) & (y <= last_y);
        if (!any(has_row)) continue;
        for (int column = 0; column < kSide; ++column) {
            const Real x = box.x0 + static_cast<float>(column);
            const Mask has_pixel = has_row & (x >= left) & (x <= last_x);
            if (!any(has_pixel)) continue;
            for (int s = 0; s < Of::kCount; ++s) {
                const float at_x = Of::kX[s] + static_cast<float>(256 * column),
                            at_y = Of::kY[s] + static_cast<float>(256 * row);
                const Mask is_inside = has_pixel & (min(min(edges[0](at_x, at_y), edges[1](at_x, at_y)),
                                                        edges[2](at_x, at_y)) >= 0);
                samples = samples | choose(is_inside, Whole(1 << ((row * kSide + column) * Of::kCount + s)), Whole(0));
            }
        }
    }
    return samples;
}

class FittingTriangles {
public:
    // Keeps the values of edge functions exact in floats, even in a block that reaches 3 pixels beyond the box: the sum
    // of two products of at most 9 and 12 times 256 is below 2^24.
    static constexpr int kMaxPixels = 8;

    INLINE void set_planes(const Plane<Real>& of) {
        const Real numbers[6]{of.x0, of.y0, of.z0, of.per_x, of.per_y, of.most};
        for (int k = 0; k < 6; ++k) store(plane_[k], numbers[k]);
    }
    // `samples`: for triangles in one block.
    INLINE void set_box(const PixelBox& box, Whole samples) {
        store_any(samples_, samples);
        const Real numbers[4]{box.x0, box.y0, box.x1, box.y1};
        for (int k = 0; k < 4; ++k) store(box_[k], numbers[k]);
    }
    INLINE void set_edges(const LaneEdge (&edges)[3]) {
        for (int e = 0; e < 3; ++e) {
            store(edges_[e][0], edges[e].per_x);
            store(edges_[e][1], edges[e].per_y);
            store(edges_[e][2], edges[e].at);
        }
    }

    INLINE Plane<float> plane(int i) const {
        return {plane_[0][i], plane_[1][i], plane_[2][i], plane_[3][i], plane_[4][i], plane_[5][i]};
    }
    INLINE int x0(int i) const { return static_cast<int>(box_[0][i]); }
    INLINE int y0(int i) const { return static_cast<int>(box_[1][i]); }
    INLINE uint32_t samples(int i) const { return samples_[i]; }

    // Calls write(x, y, mask) for blocks of the tile that have samples in triangle i.
    template <Into kInto, class Write>
    INLINE void for_blocks(int i, const Tile& tile, const Write& write) const {
        using Block = SampleBlock<kInto>;
        const int left = x0(i), top = y0(i);
        const int first_x = left > static_cast<int>(tile.x0) ? left : static_cast<int>(tile.x0),
                  first_y = top > static_cast<int>(tile.y0) ? top : static_cast<int>(tile.y0);
        const int of_x = static_cast<int>(box_[2][i]), of_y = static_cast<int>(box_[3][i]);
        const int last_x = of_x < static_cast<int>(tile.x1) ? of_x : static_cast<int>(tile.x1) - 1,
                  last_y = of_y < static_cast<int>(tile.y1) ? of_y : static_cast<int>(tile.y1) - 1;
        Real at_samples[3][Block::kVectors];
        for (int e = 0; e < 3; ++e)
            for (int v = 0; v < Block::kVectors; ++v)
                at_samples[e][v] = edges_[e][0][i] * Block::x(v) + edges_[e][1][i] * Block::y(v);
        // All of these are whole numbers, so that sums stay exact
        constexpr auto kStep = static_cast<float>(256 * Block::kSide);
        float of_row[3];
        for (int e = 0; e < 3; ++e)
            of_row[e] = edges_[e][2][i] + (edges_[e][0][i] * static_cast<float>(256 * (first_x - left)) +
                                           edges_[e][1][i] * static_cast<float>(256 * (first_y - top)));
        for (int y = first_y; y <= last_y; y += Block::kSide) {
            float at[3]{of_row[0], of_row[1], of_row[2]};
            for (int x = first_x; x <= last_x; x += Block::kSide) {
                uint32_t mask = 0;
                for (int v = 0; v < Block::kVectors; ++v)
                    mask |= bits(min(min(at_samples[0][v] + at[0], at_samples[1][v] + at[1]),
                                     at_samples[2][v] + at[2]) >= 0)
                            << (v * Lanes::kCount);
                mask &= Block::within(last_x - x + 1, last_y - y + 1);
                if (mask != 0) write(x, y, mask);
                for (int e = 0; e < 3; ++e) at[e] += kStep * edges_[e][0][i];
            }
            for (int e = 0; e < 3; ++e) of_row[e] += kStep * edges_[e][1][i];
        }
    }

private:
    alignas(64) float plane_[6][Lanes::kCount];
    float box_[4][Lanes::kCount];
    float edges_[3][3][Lanes::kCount];
    uint32_t samples_[Lanes::kCount];
};

}  // namespace
}  // namespace throng::raster
