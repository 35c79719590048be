// Makes the picture from samples and a shadow map that are complete.
#pragma once

#include "raster/shade.h"

namespace throng::raster {
namespace {

// Pixels of a row that are resolved together: the triangles in them are shaded material by material.
constexpr uint32_t kSpan = 1024;
constexpr uint32_t kMaxSamples = 4;
constexpr uint32_t kAhead = 1024;  // samples: another page, which processors do not prefetch by themselves
constexpr uint32_t kMaxMaterials = 64;
constexpr uint32_t kNone = 0xFFFFFFFF;

// A triangle in a pixel.
struct Item {
    uint32_t draw, triangle;
    uint32_t column;  // of the span
    uint32_t next;    // of the same material, or kNone
    float weight;     // the part of the pixel's samples
};

// Items of one material.
struct ItemList {
    const Material* material;
    uint32_t first, last;
};

// In a thread's scratch memory.
struct Span {
    alignas(64) float red[kSpan], green[kSpan], blue[kSpan];
    alignas(64) float background[kSpan];  // the part of the samples that show it
    Item items[kSpan * kMaxSamples];
    ItemList lists[kMaxMaterials];
    ShadeInput input;
};

class Resolve {
public:
    Resolve(const Frame& frame, Span& span) : frame_(frame), scene_(text_scene(frame)), span_(span) {}

    void run(uint32_t row, uint32_t first_column) {
        row_ = row;
        first_column_ = first_column;
        const uint32_t left = frame_.width - first_column, count = left < kSpan ? left : kSpan;
        const uint32_t end = (count + Lanes::kCount - 1) / Lanes::kCount * Lanes::kCount;
        for (uint32_t i = 0; i < end; ++i) span_.red[i] = span_.green[i] = span_.blue[i] = span_.background[i] = 0;
        const size_t first = size_t{row} * frame_.width + first_column;
        for (uint32_t i = 0; i < count; i += Lanes::kCount)
            add_pixels(frame_.samples + (first + i) * frame_.sample_count, i, count);
        shade_items();
        for (uint32_t i = 0; i < count; i += Lanes::kCount) shade_background(i);
        for (uint32_t i = 0; i < count; i += Lanes::kCount) write(i, count, frame_.pixels + 4 * first);
    }

private:
    // Adds as many pixels as there are lanes, except those from the column `end` on.
    INLINE void add_pixels(const uint64_t* samples, uint32_t column, uint32_t end) {
        const uint32_t left = end - column, pixel_count = left < Lanes::kCount ? left : uint32_t{Lanes::kCount},
                       sample_count = pixel_count * frame_.sample_count;
        constexpr uint32_t kOfLine = 64 / sizeof(uint64_t);
        for (uint32_t i = 0; i < sample_count; i += kOfLine) __builtin_prefetch(samples + kAhead + i);
        uint64_t all = 0;
        for (uint32_t i = 0; i < sample_count; ++i) all |= samples[i];
        if (all == 0) return store(span_.background + column, 1);
        for (uint32_t i = 0; i < pixel_count; ++i) add_pixel(samples + size_t{i} * frame_.sample_count, column + i);
    }

    // The samples that show the same triangle are one item.
    void add_pixel(const uint64_t* samples, uint32_t column) {
        const auto id = [samples](uint32_t i) { return ~static_cast<uint32_t>(samples[i]); };
        const uint32_t count = frame_.sample_count;
        uint32_t equal = 1;
        while (equal < count && id(equal) == id(0)) ++equal;
        if (equal == count) return add(id(0), column, 1);
        const float weight = 1 / static_cast<float>(count);
        uint32_t added = 0;  // bits of samples
        for (uint32_t i = 0; i < count; ++i) {
            if ((added >> i & 1) != 0) continue;
            float sum = 0;
            for (uint32_t k = i; k < count; ++k)
                if (id(k) == id(i)) {
                    sum += weight;
                    added |= 1u << k;
                }
            add(id(i), column, sum);
        }
    }

    void add(uint32_t id, uint32_t column, float weight) {
        if (id == kNone)
            span_.background[column] = weight;
        else if (id < frame_.first_line_id)
            add_item(id, column, weight);
        else
            add_line(frame_.lines[(id - frame_.first_line_id) / 2], column, weight);
    }

    void add_line(const Line& line, uint32_t column, float weight) {
        span_.red[column] += weight * line.color[0];
        span_.green[column] += weight * line.color[1];
        span_.blue[column] += weight * line.color[2];
    }

    void add_item(uint32_t id, uint32_t column, float weight) {
        const uint32_t draw = frame_.draw_of_ids[id / kIdBlock];
        ItemList& list = list_of(draw);
        const uint32_t item = item_count_++;
        span_.items[item] = {draw, id - frame_.draws[draw].first_id, column, kNone, weight};
        (list.first == kNone ? list.first : span_.items[list.last].next) = item;
        list.last = item;
    }

    ItemList& list_of(uint32_t draw) {
        if (draw == last_draw_) return span_.lists[last_list_];
        const Material* const material = frame_.draws[draw].material;
        uint32_t list = 0;
        while (list < list_count_ && span_.lists[list].material != material) ++list;
        if (list == kMaxMaterials) {
            shade_items();
            list = 0;
        }
        if (list == list_count_) span_.lists[list_count_++] = {material, kNone, kNone};
        last_draw_ = draw;
        last_list_ = list;
        return span_.lists[list];
    }

    // Shades all items that have been added.
    void shade_items() {
        for (uint32_t i = 0; i < list_count_; ++i)
            for (uint32_t item = span_.lists[i].first; item != kNone;)
                item = shade_lanes(*span_.lists[i].material, item);
        item_count_ = list_count_ = 0;
        last_draw_ = kNone;
    }

    // Returns the first item that has no lane.
    uint32_t shade_lanes(const Material& material, uint32_t item) {
        uint32_t columns[Lanes::kCount], count = 0;
        float weights[Lanes::kCount];
        const bool has_textures = is_textured(material);
        for (; count < Lanes::kCount && item != kNone; ++count) {
            const Item& of = span_.items[item];
            span_.input.set(count, frame_.draws[of.draw], of.triangle, first_column_ + of.column, has_textures,
                            frame_.has_colors);
            columns[count] = of.column;
            weights[count] = of.weight;
            item = of.next;
        }
        for (uint32_t lane = count; lane < Lanes::kCount; ++lane) span_.input.copy(lane, 0);
        prefetch(item);
        const vec3 color = shaded(frame_, scene_, material, span_.input, static_cast<float>(row_));
        for (uint32_t lane = 0; lane < count; ++lane) {
            span_.red[columns[lane]] += weights[lane] * color.x.v[lane];
            span_.green[columns[lane]] += weights[lane] * color.y.v[lane];
            span_.blue[columns[lane]] += weights[lane] * color.z.v[lane];
        }
        return item;
    }

    // Prefetches what the next lanes read: vertices are most of a frame's memory.
    INLINE void prefetch(uint32_t item) const {
        for (uint32_t lane = 0; lane < Lanes::kCount && item != kNone; ++lane, item = span_.items[item].next) {
            const Draw& draw = frame_.draws[span_.items[item].draw];
            for (const uint32_t* const corners : draw.section->corners) {
                __builtin_prefetch(draw.vertices + place_of(corners[span_.items[item].triangle]));
            }
        }
    }

    void shade_background(uint32_t column) {
        const Real weight = load(span_.background + column);
        if (!any(weight > 0)) return;
        const vec3 color = shaded_background(frame_, scene_, first_column_ + column, row_);
        store(span_.red + column, load(span_.red + column) + weight * color.x);
        store(span_.green + column, load(span_.green + column) + weight * color.y);
        store(span_.blue + column, load(span_.blue + column) + weight * color.z);
    }

    void write(uint32_t column, uint32_t end, uint8_t* bytes) const {
        const auto encoded = [&](const float* of) {
            const Real at = clamp(load(of + column), 0, 1) * static_cast<float>(kSrgbSteps) + 0.5f;
            return gather(frame_.srgb, truncated(at));
        };
        const float* const lowest = frame_.blue_first ? span_.blue : span_.red;
        const float* const highest = frame_.blue_first ? span_.red : span_.blue;
        const Whole pixels = encoded(lowest) | (encoded(span_.green) << 8) | (encoded(highest) << 16) |
                             Whole(static_cast<int32_t>(0xFF000000));
        alignas(64) uint32_t words[Lanes::kCount];
        store_any(words, pixels);
        const uint32_t left = end - column, count = left < Lanes::kCount ? left : uint32_t{Lanes::kCount};
        __builtin_memcpy(bytes + 4 * size_t{column}, words, 4 * size_t{count});
    }

    const Frame& frame_;
    const TextScene scene_;
    Span& span_;
    uint32_t row_ = 0, first_column_ = 0;
    uint32_t item_count_ = 0, list_count_ = 0;
    uint32_t last_draw_ = kNone, last_list_ = 0;
};

void resolve(const Frame& frame, uint32_t first_row, uint32_t end_row, std::byte* scratch) {
    Resolve resolve(frame, *reinterpret_cast<Span*>(scratch));
    for (uint32_t row = first_row; row < end_row; ++row)
        for (uint32_t column = 0; column < frame.width; column += kSpan) resolve.run(row, column);
}

}  // namespace
}  // namespace throng::raster
