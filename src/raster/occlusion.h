// Skips draws that nearer draws of the tile hide, by the farthest depth in each cell of pixels. Exact: a draw is left
// out only where all its samples would lie behind what is there, so that the picture is the same. The idea: N. Greene,
// M. Kass and G. Miller, Hierarchical Z-Buffer Visibility, SIGGRAPH 1993.
#pragma once

#include "raster/frame.h"
#include "raster/lane_types.h"

namespace throng::raster {
namespace {

class Occlusion {
public:
    // Pixels, each way.
    static constexpr uint32_t kCell = 8;
    static size_t scratch_bytes(const Frame& frame) { return size_t{cells(frame.width)} * cells(frame.height) * 4; }

    Occlusion(const Frame& frame, const Tile& tile, std::byte* scratch)
        : frame_(frame), tile_(tile), columns_(cells(tile.x1 - tile.x0)), farthest_(reinterpret_cast<float*>(scratch)) {
        const uint32_t count = columns_ * cells(tile.y1 - tile.y0);
        for (uint32_t i = 0; i < count; ++i) farthest_[i] = 0;
    }

    enum class Hides { kNothing, kSome, kAll };
    // How much of a draw that lies in the tile is hidden.
    Hides hides(const Draw& draw) {
        uint32_t hidden = 0, count = 0;
        for_cells(cells_of(draw), [&](float& farthest, uint32_t x, uint32_t y) {
            if (farthest < 0) farthest = look(x, y);
            hidden += farthest > draw.nearest;
            ++count;
            return true;
        });
        return hidden == 0 ? Hides::kNothing : hidden < count ? Hides::kSome : Hides::kAll;
    }
    // Whether a box of the draw's pixels, some of them in the tile, is hidden entirely. Call it after hides(draw),
    // which looks at the samples of cells that are not up to date; until then they hide nothing.
    bool hides(const Draw& draw, float x0, float y0, float x1, float y1) const {
        bool hides_all = true;
        for_cells(cells_of(x0, y0, x1, y1), [&](float farthest, uint32_t, uint32_t) {
            hides_all = farthest > draw.nearest;
            return hides_all;
        });
        return hides_all;
    }
    void has_drawn(const Draw& draw) {
        for_cells(cells_of(draw), [](float& farthest, uint32_t, uint32_t) {
            farthest = kUnknown;
            return true;
        });
    }

private:
    static constexpr float kUnknown = -1;
    static uint32_t cells(uint32_t pixels) { return (pixels + kCell - 1) / kCell; }

    struct Cells {
        uint32_t x0, y0, x1, y1;  // the last ones included
    };
    INLINE Cells cells_of(float x0, float y0, float x1, float y1) const {
        const auto cell = [](float at, uint32_t from, uint32_t to) {
            const auto low = static_cast<float>(from), high = static_cast<float>(to - 1);
            return (static_cast<uint32_t>(at < low ? low : at > high ? high : at) - from) / kCell;
        };
        return {cell(x0, tile_.x0, tile_.x1), cell(y0, tile_.y0, tile_.y1), cell(x1, tile_.x0, tile_.x1),
                cell(y1, tile_.y0, tile_.y1)};
    }
    INLINE Cells cells_of(const Draw& draw) const {
        const auto& box = draw.picture_box;
        return cells_of(box[0], box[1], box[2], box[3]);
    }
    // Calls visit(farthest, x, y) for each cell, until it returns false.
    template <class Visit>
    INLINE void for_cells(const Cells& in, const Visit& visit) const {
        for (uint32_t y = in.y0; y <= in.y1; ++y)
            for (uint32_t x = in.x0; x <= in.x1; ++x)
                if (!visit(farthest_[y * columns_ + x], x, y)) return;
    }

    float look(uint32_t column, uint32_t row) const {
        const uint32_t x0 = tile_.x0 + column * kCell, y0 = tile_.y0 + row * kCell;
        const uint32_t x1 = x0 + kCell < tile_.x1 ? x0 + kCell : tile_.x1,
                       y1 = y0 + kCell < tile_.y1 ? y0 + kCell : tile_.y1;
        int64_t least = INT64_MAX;  // depths are above 0, and samples below 2^63
        for (uint32_t y = y0; y < y1; ++y) {
            const uint64_t* const samples = frame_.samples + (size_t{y} * frame_.width + x0) * frame_.sample_count;
            for (uint32_t i = 0; i < (x1 - x0) * frame_.sample_count; ++i) {
                const auto sample = static_cast<int64_t>(samples[i]);
                least = sample < least ? sample : least;
            }
            if (least == 0) break;
        }
        return __builtin_bit_cast(float, static_cast<uint32_t>(least >> 32));
    }

    const Frame& frame_;
    const Tile tile_;
    const uint32_t columns_;
    float* const farthest_;  // [row][column]
};

}  // namespace
}  // namespace throng::raster
