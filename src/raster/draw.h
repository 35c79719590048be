// The triangles of a tile: as many at a time as there are lanes. Most triangles of a crowd are smaller than a pixel or
// two; those are tested at all samples of two by two pixels at once, the others one by one (fill.h).
#pragma once

#include "raster/clip.h"
#include "raster/mask.h"
#include "raster/occlusion.h"

namespace throng::raster {
namespace {

// Vertices of a draw on the screen.
struct Screen {
    float* xy;  // [vertex][2], subpixels, or kFarAway
    float* z;   // depth, or height
};

INLINE uint32_t whole_blocks(uint32_t count) { return (count + kBlock - 1) / kBlock * kBlock; }

INLINE Screen screen_in(std::byte* scratch, const Frame& frame) {
    float* const floats = reinterpret_cast<float*>(scratch);
    const size_t room = whole_blocks(frame.most_vertices);
    return {floats, floats + 2 * room};
}

INLINE size_t screen_bytes(const Frame& frame) { return size_t{3} * sizeof(float) * whole_blocks(frame.most_vertices); }
size_t scratch_bytes_to_draw(const Frame& frame) { return screen_bytes(frame) + Occlusion::scratch_bytes(frame); }

template <Into kInto>
auto projection(const Frame& frame) {
    if constexpr (kInto == Into::kMap)
        return ToMap(frame);
    else
        return ToPicture(frame);
}

template <Into kInto>
void project(const Frame& frame, const Draw& draw, const Screen& to) {
    const auto screen_from_world = projection<kInto>(frame);
    for (uint32_t first = 0; first < draw.section->vertex_count; first += kBlock) {
        const float* const block = draw.vertices + first / kBlock * kBlockFloats;
        for (uint32_t i = 0; i < kBlock; i += Lanes::kCount) {
            const ScreenPoint at = screen_from_world.point(load(block + i), load(block + kBlock + i),
                                                           load(block + 2 * kBlock + i));
            store_pairs(to.xy + 2 * (first + i), at.x, at.y);
            store(to.z + first + i, at.depth);
        }
    }
}

// Of a material with a mask: pixels of triangles that wait for the texture to be read, as many at a time as lanes.
template <Into kInto>
class Fragments {
public:
    Fragments(const Draw& draw, const Target<kInto>& target) : draw_(draw), target_(target) {}

    // `samples`: bits of those in the triangle.
    void add(int x, int y, uint32_t samples, const Plane& plane, uint32_t triangle) {
        x_[count_] = static_cast<uint32_t>(x);
        y_[count_] = static_cast<uint32_t>(y);
        triangles_[count_] = triangle;
        samples_[count_] = samples;
        planes_[count_] = plane;
        if (++count_ == Lanes::kCount) finish();
    }
    void finish() {
        if (count_ == 0) return;
        for (uint32_t i = count_; i < Lanes::kCount; ++i) {
            x_[i] = x_[0];
            y_[i] = y_[0];
            triangles_[i] = triangles_[0];
        }
        const Mask passes = mask_passes(target_.frame, draw_, kInto == Into::kMap, load_any(triangles_), load_any(x_),
                                        load_any(y_));
        for (uint32_t rest = bits(passes & first_lanes(count_)); rest != 0; rest &= rest - 1) {
            const int i = __builtin_ctz(rest);
            const int x = static_cast<int>(x_[i]), y = static_cast<int>(y_[i]);
            for (uint32_t samples = samples_[i]; samples != 0; samples &= samples - 1) {
                const int sample = __builtin_ctz(samples);
                const float depth = planes_[i].at(static_cast<float>(256 * x) + Pattern<kInto>::kX[sample],
                                                  static_cast<float>(256 * y) + Pattern<kInto>::kY[sample]);
                target_.write(x, y, static_cast<uint32_t>(sample), depth, draw_.first_id + triangles_[i]);
            }
        }
        count_ = 0;
    }

private:
    const Draw& draw_;
    const Target<kInto> target_;
    uint32_t count_ = 0;
    alignas(64) uint32_t x_[Lanes::kCount], y_[Lanes::kCount], triangles_[Lanes::kCount];
    uint32_t samples_[Lanes::kCount];
    Plane planes_[Lanes::kCount];
};

template <Into kInto, bool kMasked>
class DrawTriangles {
public:
    // `occlusion`: of what hides some of the draw; or null.
    DrawTriangles(const Frame& frame, const Tile& tile, const Draw& draw, const Screen& screen,
                  const Occlusion* occlusion)
        : frame_(frame),
          tile_(tile),
          draw_(draw),
          section_(*draw.section),
          screen_(screen),
          occlusion_(occlusion),
          target_(frame, tile),
          fragments_(draw, target_),
          culls_(kInto != Into::kMap && !section_.material->is_double_sided) {}

    void run() {
        for (uint32_t first = 0; first < section_.triangle_count; first += Lanes::kCount) draw_lanes(first);
        if constexpr (kMasked) fragments_.finish();
    }

private:
    using Of = Pattern<kInto>;
    using Block = SampleBlock<kInto>;

    struct Corner {
        Real x, y;
        Whole vertex;
    };
    INLINE Corner corner(int which, uint32_t first) const {
        const Whole vertex = load_any(section_.corners[which] + first);
        Corner corner;
        gather_pairs(screen_.xy, section_.corners[which] + first, corner.x, corner.y);
        corner.vertex = vertex;
        return corner;
    }

    INLINE void draw_lanes(uint32_t first) {
        const Corner a = corner(0, first), b = corner(1, first), c = corner(2, first);
        const Real x0 = min(min(a.x, b.x), c.x), x1 = max(max(a.x, b.x), c.x), y0 = min(min(a.y, b.y), c.y),
                   y1 = max(max(a.y, b.y), c.y);
        // The pixels of which some sample lies in the box.
        constexpr float kPerPixel = 1 / kSubpixels;
        const Real column0 = -floor((Real(float{Of::kLast}) - x0) * kPerPixel),
                   column1 = floor((x1 - float{Of::kFirst}) * kPerPixel),
                   row0 = -floor((Real(float{Of::kLast}) - y0) * kPerPixel),
                   row1 = floor((y1 - float{Of::kFirst}) * kPerPixel);
        const auto left = static_cast<float>(tile_.x0), top = static_cast<float>(tile_.y0),
                   right = static_cast<float>(tile_.x1 - 1), bottom = static_cast<float>(tile_.y1 - 1);
        const Real first_column = max(column0, left), last_column = min(column1, right), first_row = max(row0, top),
                   last_row = min(row1, bottom);
        const Mask is_clipped = max(x1, y1) >= kFarAway;
        Mask live = ((first_column <= last_column) & (first_row <= last_row)) | is_clipped;
        live = live & first_lanes(section_.triangle_count - first);
        if (!any(live)) return;
        if (occlusion_ && !any(is_clipped) && hides(live, first_column, first_row, last_column, last_row)) return;

        const Mask is_small = live & ~is_clipped & (column1 - column0 <= 1) & (row1 - row0 <= 1);
        const uint32_t small = bits(is_small);
        if (small != 0)
            draw_small(first, a, b, c, is_small, column0, row0, last_column, last_row, first_column, first_row);
        for (uint32_t rest = bits(live) & ~small; rest != 0; rest &= rest - 1)
            draw_one(first + static_cast<uint32_t>(__builtin_ctz(rest)));
    }

    INLINE bool hides(Mask live, Real x0, Real y0, Real x1, Real y1) const {
        return occlusion_->hides(draw_, least(choose(live, x0, kFarAway)), least(choose(live, y0, kFarAway)),
                                 greatest(choose(live, x1, 0)), greatest(choose(live, y1, 0)));
    }

    // Triangles of which all samples lie in two by two pixels.
    INLINE void draw_small(uint32_t first, const Corner& a, const Corner& b, const Corner& c, Mask is_small,
                           Real column0, Real row0, Real last_column, Real last_row, Real first_column,
                           Real first_row) {
        const Real x1 = b.x - a.x, y1 = b.y - a.y, x2 = c.x - a.x, y2 = c.y - a.y;
        const Real area = x2 * y1 - x1 * y2;  // exact, as all products here are: of 12 bits
        Mask live = is_small & (area != 0);
        if (culls_) live = live & (draw_.is_mirrored ? area < 0 : area > 0);
        if (!any(live)) return;
        const Real side = choose(area < 0, 1.0f, -1.0f);
        const Real left = column0 * kSubpixels, top = row0 * kSubpixels;
        struct SmallEdge {
            Real per_x, per_y, at;
            INLINE SmallEdge(const Corner& from, const Corner& to, Real side, Real left, Real top) {
                per_x = (from.y - to.y) * side;
                per_y = (to.x - from.x) * side;
                const Mask is_top_or_left = (per_x > 0) | ((per_x == 0) & (per_y > 0));
                at = per_x * (left - from.x) + per_y * (top - from.y) - choose(is_top_or_left, 0.0f, 1.0f);
            }
            INLINE Real operator()(float x, float y) const { return at + (per_x * x + per_y * y); }
        };
        const SmallEdge ab(a, b, side, left, top), bc(b, c, side, left, top), ca(c, a, side, left, top);

        const Mask two_columns = live & (column0 + 1 <= last_column), two_rows = live & (row0 + 1 <= last_row),
                   first_columns = first_column <= column0, first_rows = first_row <= row0;
        const bool has_two_columns = any(two_columns), has_two_rows = any(two_rows);
        Whole samples = 0;
        for (int pixel = 0; pixel < 4; ++pixel) {
            const bool is_right = pixel & 1, is_below = pixel & 2;
            if ((is_right && !has_two_columns) || (is_below && !has_two_rows)) continue;
            const Mask has_pixel = live & (is_right ? two_columns : first_columns) & (is_below ? two_rows : first_rows);
            for (int s = 0; s < Of::kCount; ++s) {
                const float x = Of::kX[s] + (is_right ? 256.0f : 0.0f), y = Of::kY[s] + (is_below ? 256.0f : 0.0f);
                const Mask inside = has_pixel & (min(min(ab(x, y), bc(x, y)), ca(x, y)) >= 0);
                samples = samples | choose(inside, Whole(1 << (pixel * Of::kCount + s)), Whole(0));
            }
        }
        const uint32_t hit = bits(live & ~(samples == 0));
        if (hit == 0) return;

        const Real z0 = gather(screen_.z, a.vertex), of_b = gather(screen_.z, b.vertex),
                   of_c = gather(screen_.z, c.vertex);
        const Real z1 = of_b - z0, z2 = of_c - z0;
        const Real per_area = Real(-1) / area;
        alignas(64) float numbers[8][Lanes::kCount];
        store(numbers[0], a.x);
        store(numbers[1], a.y);
        store(numbers[2], z0);
        store(numbers[3], (z1 * y2 - z2 * y1) * per_area);
        store(numbers[4], (z2 * x1 - z1 * x2) * per_area);
        store(numbers[5], column0);
        store(numbers[6], row0);
        store(numbers[7], max(max(of_b, of_c), z0));
        alignas(64) uint32_t covered[Lanes::kCount];
        store_any(covered, samples);
        for (uint32_t rest = hit; rest != 0; rest &= rest - 1) {
            const int i = __builtin_ctz(rest);
            Plane plane{numbers[0][i], numbers[1][i], numbers[2][i], numbers[3][i], numbers[4][i], numbers[7][i]};
            if constexpr (kInto == Into::kMap) plane.bias();
            write_small(static_cast<int>(numbers[5][i]), static_cast<int>(numbers[6][i]), covered[i], plane,
                        first + static_cast<uint32_t>(i));
        }
    }

    // `samples`: of two by two pixels, one pixel's after another's.
    INLINE void write_small(int x, int y, uint32_t samples, const Plane& plane, uint32_t triangle) {
        if constexpr (!kMasked && kInto == Into::kPicture4) return write_block(x, y, samples, plane, triangle);
        constexpr uint32_t kOfPixel = (1u << Of::kCount) - 1;
        for (int pixel = 0; pixel < 4; ++pixel) {
            const uint32_t of_pixel = samples >> (pixel * Of::kCount) & kOfPixel;
            if (of_pixel == 0) continue;
            const int px = x + (pixel & 1), py = y + (pixel >> 1);
            if constexpr (kMasked)
                fragments_.add(px, py, of_pixel, plane, triangle);
            else
                target_.write(
                    px, py, 0,
                    plane.at(static_cast<float>(256 * px) + Of::kX[0], static_cast<float>(256 * py) + Of::kY[0]),
                    draw_.first_id + triangle);
        }
    }

    INLINE void write_block(int x, int y, uint32_t mask, const Plane& plane, uint32_t triangle) {
        alignas(64) float depths[16];
        const auto left = static_cast<float>(256 * x), top = static_cast<float>(256 * y);
        for (int v = 0; v < Block::kVectors; ++v)
            store(depths + v * Lanes::kCount, plane.at(Block::x(v) + left, Block::y(v) + top));
        target_.write_block(x, y, mask, depths, draw_.first_id + triangle);
    }

    // Any triangle.
    void draw_one(uint32_t triangle) {
        const uint32_t vertices[3]{section_.corners[0][triangle], section_.corners[1][triangle],
                                   section_.corners[2][triangle]};
        ScreenTriangle on_screen;
        bool is_clipped = false;
        for (int k = 0; k < 3; ++k) {
            const float x = screen_.xy[2 * vertices[k]], y = screen_.xy[2 * vertices[k] + 1];
            is_clipped = is_clipped || x >= kFarAway || y >= kFarAway;
            on_screen.x[k] = static_cast<int32_t>(x);
            on_screen.y[k] = static_cast<int32_t>(y);
            on_screen.z[k] = screen_.z[vertices[k]];
        }
        if (!is_clipped) return fill_triangle(on_screen, triangle);
        ClipVertex corners[3];
        for (int k = 0; k < 3; ++k) corners[k] = clip_vertex(vertices[k]);
        clip_triangle<kInto>(frame_, corners, [&](const ScreenTriangle& part) { fill_triangle(part, triangle); });
    }

    ClipVertex clip_vertex(uint32_t vertex) const {
        const float* const block = draw_.vertices + vertex / kBlock * kBlockFloats + vertex % kBlock;
        const double x = double{block[0]}, y = double{block[kBlock]}, z = double{block[2 * kBlock]};
        const auto times = [&](const float(&row)[4]) {
            return double{row[0]} * x + double{row[1]} * y + double{row[2]} * z + double{row[3]};
        };
        const Scene& scene = frame_.scene;
        if constexpr (kInto == Into::kMap)
            return {2 * times(scene.map_from_world[0]) - 1,
                    2 * times(scene.map_from_world[1]) - 1,
                    1,
                    times(scene.map_from_world[2]),
                    screen_.xy[2 * vertex],
                    screen_.xy[2 * vertex + 1]};
        else
            return {times(scene.clip_from_world[0]), times(scene.clip_from_world[1]),
                    times(scene.clip_from_world[3]), 0,
                    screen_.xy[2 * vertex],          screen_.xy[2 * vertex + 1]};
    }

    void fill_triangle(const ScreenTriangle& t, uint32_t triangle) {
        const int64_t area = doubled_area(t);
        if (area == 0 || (culls_ && (area > 0) == draw_.is_mirrored)) return;
        Plane plane = plane_of(t, area);
        if constexpr (kInto == Into::kMap) plane.bias();
        fill<kInto>(t, tile_, area, [&](int x, int y, uint32_t mask) {
            if constexpr (!kMasked) return write_block(x, y, mask, plane, triangle);
            constexpr uint32_t kOfPixel = (1u << Of::kCount) - 1;
            for (int pixel = 0; pixel < Block::kSide * Block::kSide; ++pixel)
                if (const uint32_t of_pixel = mask >> (pixel * Of::kCount) & kOfPixel)
                    fragments_.add(x + pixel % Block::kSide, y + pixel / Block::kSide, of_pixel, plane, triangle);
        });
    }

    const Frame& frame_;
    const Tile tile_;
    const Draw& draw_;
    const Section& section_;
    const Screen screen_;
    const Occlusion* const occlusion_;
    const Target<kInto> target_;
    Fragments<kInto> fragments_;
    const bool culls_;
};

template <Into kInto>
void draw_lines(const Frame& frame, const Tile& tile) {
    const Target<kInto> target(frame, tile);
    using Block = SampleBlock<kInto>;
    for (uint32_t i = 0; i < frame.line_count; ++i) {
        const Line& line = frame.lines[i];
        constexpr int kTriangles[2][3]{{0, 1, 2}, {2, 1, 3}};
        for (uint32_t half = 0; half < 2; ++half) {
            ClipVertex corners[3];
            for (int k = 0; k < 3; ++k) {
                const float(&at)[4] = line.corners[kTriangles[half][k]];
                corners[k] = {double{at[0]}, double{at[1]}, double{at[3]}, 0};
            }
            clip_triangle<kInto>(frame, corners, [&](ScreenTriangle t) {
                if (i >= frame.depth_tested_count)
                    for (float& z : t.z) z = kOverEverything;
                const int64_t area = doubled_area(t);
                if (area == 0) return;
                const Plane plane = plane_of(t, area);
                fill<kInto>(t, tile, area, [&](int x, int y, uint32_t mask) {
                    alignas(64) float depths[16];
                    const auto left = static_cast<float>(256 * x), top = static_cast<float>(256 * y);
                    for (int v = 0; v < Block::kVectors; ++v)
                        store(depths + v * Lanes::kCount, plane.at(Block::x(v) + left, Block::y(v) + top));
                    target.write_block(x, y, mask, depths, frame.first_line_id + 2 * i + half);
                });
            });
        }
    }
}

INLINE bool lies_in(const float (&box)[4], const Tile& tile) {
    return box[2] >= static_cast<float>(tile.x0) && box[3] >= static_cast<float>(tile.y0) &&
           box[0] <= static_cast<float>(tile.x1) && box[1] <= static_cast<float>(tile.y1);
}

template <Into kInto>
void draw_triangles(const Frame& frame, const Tile& tile, const Draw& draw, const Screen& screen,
                    const Occlusion* occlusion) {
    project<kInto>(frame, draw, screen);
    if (draw.section->material->is_masked)
        DrawTriangles<kInto, true>(frame, tile, draw, screen, occlusion).run();
    else
        DrawTriangles<kInto, false>(frame, tile, draw, screen, occlusion).run();
}

// Of each row of the tile, items [columns of the tile].
template <class Item>
INLINE void clear(Item* items, uint32_t columns, uint32_t items_of_pixel, const Tile& tile) {
    for (uint32_t y = tile.y0; y < tile.y1; ++y)
        __builtin_memset(items + (size_t{y} * columns + tile.x0) * items_of_pixel, 0,
                         (tile.x1 - tile.x0) * items_of_pixel * sizeof(Item));
}

// Returns whether there is anything to draw.
template <Into kInto>
bool draw_tile(const Frame& frame, const Tile& tile, std::byte* scratch) {
    const Screen screen = screen_in(scratch, frame);
    Occlusion occlusion(frame, tile, scratch + screen_bytes(frame));
    bool has_draws = false;
    for (uint32_t i = 0; i < frame.draw_count; ++i) {
        const Draw& draw = frame.draws[frame.nearest_first[i]];
        if (!lies_in(draw.picture_box, tile)) continue;
        has_draws = true;
        const Occlusion::Hides hides = occlusion.hides(draw);
        if (hides == Occlusion::Hides::kAll) continue;
        draw_triangles<kInto>(frame, tile, draw, screen, hides == Occlusion::Hides::kSome ? &occlusion : nullptr);
        occlusion.has_drawn(draw);
    }
    draw_lines<kInto>(frame, tile);
    return has_draws;
}

bool draw_map(const Frame& frame, const Tile& tile, bool is_clear, std::byte* scratch) {
    if (!is_clear) clear(frame.map, frame.map_size, 1, tile);
    const Screen screen = screen_in(scratch, frame);
    is_clear = true;
    for (uint32_t i = 0; i < frame.draw_count; ++i) {
        if (!lies_in(frame.draws[i].map_box, tile)) continue;
        draw_triangles<Into::kMap>(frame, tile, frame.draws[i], screen, nullptr);
        is_clear = false;
    }
    return is_clear;
}

bool draw_picture(const Frame& frame, const Tile& tile, bool is_clear, std::byte* scratch) {
    if (!is_clear) clear(frame.samples, frame.width, frame.sample_count, tile);
    const bool has_draws = frame.sample_count == 4 ? draw_tile<Into::kPicture4>(frame, tile, scratch)
                                                   : draw_tile<Into::kPicture1>(frame, tile, scratch);
    return !has_draws && frame.line_count == 0;
}

}  // namespace
}  // namespace throng::raster
