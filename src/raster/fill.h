// Fills one triangle of any size, exactly: edges are computed in integers, so that each sample belongs to just one of
// two triangles that share an edge, by Vulkan's rule of the top and left edges.
#pragma once

#include "raster/samples.h"

namespace throng::raster {
namespace {

// Subpixels, within kGuard; depths, or heights.
struct ScreenTriangle {
    int32_t x[3], y[3];
    float z[3];
};

// Greater than 0 if the corners go counter-clockwise on the screen (y down): the front, unless Draw::is_mirrored.
INLINE int64_t doubled_area(const ScreenTriangle& t) {
    return int64_t{t.x[2] - t.x[0]} * (t.y[1] - t.y[0]) - int64_t{t.x[1] - t.x[0]} * (t.y[2] - t.y[0]);
}

template <Into kInto>
INLINE Plane<float> plane_of(const ScreenTriangle& t, int64_t doubled_area) {
    const Sides<float> sides{static_cast<float>(t.x[1] - t.x[0]), static_cast<float>(t.y[1] - t.y[0]),
                             static_cast<float>(t.x[2] - t.x[0]), static_cast<float>(t.y[2] - t.y[0])};
    return plane_of<kInto>(static_cast<float>(t.x[0]), static_cast<float>(t.y[0]), sides, t.z,
                           -1 / static_cast<float>(doubled_area));
}

// An edge function at the samples of a block. Samples lie at multiples of 32 subpixels, so its values divided by 32,
// rounded down, are enough. Differences within a block then fit into 31 bits (edges span up to 2^24 + 2^24 subpixels, a
// block 28 + 28 steps of 32).
struct Edge {
    int64_t per_x, per_y;  // the change when x, or y, grows by 32 subpixels, divided by 32
    int64_t at_origin;     // of the picture

    INLINE Edge(const ScreenTriangle& t, int from, int to, int side) {
        per_x = int64_t{side} * (t.y[from] - t.y[to]);
        per_y = int64_t{side} * (t.x[to] - t.x[from]);
        const bool is_top_or_left = per_x > 0 || (per_x == 0 && per_y > 0);
        at_origin = (-per_x * t.x[from] - per_y * t.y[from] - (is_top_or_left ? 0 : 1)) >> 5;
    }
    INLINE int64_t at_pixel(int x, int y) const { return at_origin + 8 * (per_x * x + per_y * y); }
    // The greatest value in a square of `side` pixels each way that begins at x, y.
    INLINE int64_t greatest(int x, int y, int side) const {
        return at_pixel(x, y) + 8 * side * ((per_x > 0 ? per_x : 0) + (per_y > 0 ? per_y : 0));
    }
    INLINE Whole difference(Real x, Real y) const {
        return Whole(static_cast<int32_t>(per_x)) * truncated(x * (1 / 32.0f)) +
               Whole(static_cast<int32_t>(per_y)) * truncated(y * (1 / 32.0f));
    }
};

INLINE int32_t within_31_bits(int32_t value) { return value; }
INLINE int32_t within_31_bits(int64_t value) {
    constexpr int64_t kMaximum = 1 << 30;
    return static_cast<int32_t>(value < -kMaximum ? -kMaximum : value > kMaximum ? kMaximum : value);
}

struct Box {
    int x0, y0, x1, y1;  // pixels, the last ones included
};

// Calls write(x, y, mask) for each block that has samples in the triangle.
template <Into kInto, class Write>
void fill(const ScreenTriangle& t, const Tile& tile, int64_t area, const Write& write) {
    using Block = SampleBlock<kInto>;
    using Of = Pattern<kInto>;
    const auto least = [](const int32_t(&a)[3]) {
        return a[0] < a[1] ? (a[0] < a[2] ? a[0] : a[2]) : (a[1] < a[2] ? a[1] : a[2]);
    };
    const auto most = [](const int32_t(&a)[3]) {
        return a[0] > a[1] ? (a[0] > a[2] ? a[0] : a[2]) : (a[1] > a[2] ? a[1] : a[2]);
    };
    const auto lower = [](int a, uint32_t b) { return a < static_cast<int>(b) ? a : static_cast<int>(b); };
    const auto upper = [](int a, uint32_t b) { return a > static_cast<int>(b) ? a : static_cast<int>(b); };
    const Box box{upper((least(t.x) - Of::kLast + 255) >> 8, tile.x0),
                  upper((least(t.y) - Of::kLast + 255) >> 8, tile.y0),
                  lower((most(t.x) - Of::kFirst) >> 8, tile.x1 - 1), lower((most(t.y) - Of::kFirst) >> 8, tile.y1 - 1)};
    if (box.x0 > box.x1 || box.y0 > box.y1 || area == 0) return;

    const int side = area < 0 ? 1 : -1;
    const Edge edges[3]{{t, 0, 1, side}, {t, 1, 2, side}, {t, 2, 0, side}};
    Whole differences[3][Block::kVectors];
    for (int e = 0; e < 3; ++e)
        for (int v = 0; v < Block::kVectors; ++v) differences[e][v] = edges[e].difference(Block::x(v), Block::y(v));

    // Number: a type that the edges' values in `part` fit into.
    const auto fill_box = [&]<class Number>(const Box& part, Number) {
        constexpr int kSide = Block::kSide;
        Number of_row[3], right[3], down[3];
        for (int e = 0; e < 3; ++e) {
            of_row[e] = static_cast<Number>(edges[e].at_pixel(part.x0, part.y0));
            right[e] = static_cast<Number>(8 * kSide * edges[e].per_x);
            down[e] = static_cast<Number>(8 * kSide * edges[e].per_y);
        }
        for (int y = part.y0; y <= part.y1; y += kSide) {
            Number at[3]{of_row[0], of_row[1], of_row[2]};
            for (int x = part.x0; x <= part.x1; x += kSide) {
                const Whole first[3]{within_31_bits(at[0]), within_31_bits(at[1]), within_31_bits(at[2])};
                uint32_t outside = 0;
                for (int v = 0; v < Block::kVectors; ++v)
                    outside |= bits(((first[0] + differences[0][v]) | (first[1] + differences[1][v]) |
                                     (first[2] + differences[2][v])) < 0)
                               << (v * Lanes::kCount);
                const uint32_t mask = ~outside & Block::within(part.x1 - x + 1, part.y1 - y + 1);
                if (mask != 0) write(x, y, mask);
                for (int e = 0; e < 3; ++e) at[e] += right[e];
            }
            for (int e = 0; e < 3; ++e) of_row[e] += down[e];
        }
    };
    constexpr int kCell = 16;  // pixels
    const bool is_large = most(t.x) - least(t.x) > 64 * 256 || most(t.y) - least(t.y) > 64 * 256;
    if (!is_large) return fill_box(box, int32_t{});  // values below 2^14 * 2^14 * 2 / 32
    // Skips the cells of a large triangle's box that lie wholly outside the triangle.
    for (int y = box.y0; y <= box.y1; y += kCell)
        for (int x = box.x0; x <= box.x1; x += kCell) {
            if (edges[0].greatest(x, y, kCell) < 0 || edges[1].greatest(x, y, kCell) < 0 ||
                edges[2].greatest(x, y, kCell) < 0)
                continue;
            const int last_x = x + kCell - 1, last_y = y + kCell - 1;
            fill_box({x, y, last_x < box.x1 ? last_x : box.x1, last_y < box.y1 ? last_y : box.y1}, int64_t{});
        }
}

}  // namespace
}  // namespace throng::raster
