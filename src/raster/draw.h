// Draws the triangles of a tile, as many at a time as there are lanes. Most triangles of a crowd lie in one block of
// samples, and are tested in lanes. Those of a few more pixels are tested one by one with edges that were set up in
// lanes (fitting.h), larger ones entirely one by one (fill.h).
#pragma once

#include "raster/clip.h"
#include "raster/fitting.h"
#include "raster/fragments.h"
#include "raster/lines.h"
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
    const size_t room = whole_blocks(frame.max_vertices);
    return {floats, floats + 2 * room};
}

INLINE size_t screen_bytes(const Frame& frame) { return size_t{3} * sizeof(float) * whole_blocks(frame.max_vertices); }
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
            const float* const fours = block + i / kFour * kFourFloats;
            const ScreenPoint at = screen_from_world.point(load_fours(fours, kFourFloats),
                                                           load_fours(fours + kFour, kFourFloats),
                                                           load_fours(fours + 2 * kFour, kFourFloats));
            store_pairs(to.xy + 2 * (first + i), at.x, at.y);
            store(to.z + first + i, at.depth);
        }
    }
}

template <Into kInto, bool kMasked>
class DrawTriangles {
public:
    // `occlusion`: null if nothing of the draw is hidden.
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
          culls_(kInto != Into::kMap && !draw.material->is_double_sided) {}

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
        // The pixels with a sample in the box.
        constexpr float kPerPixel = 1 / kSubpixels;
        const PixelBox box{-floor((Real(float{Of::kLast}) - x0) * kPerPixel),
                           -floor((Real(float{Of::kLast}) - y0) * kPerPixel),
                           floor((x1 - float{Of::kFirst}) * kPerPixel), floor((y1 - float{Of::kFirst}) * kPerPixel)};
        const auto left = static_cast<float>(tile_.x0), top = static_cast<float>(tile_.y0),
                   right = static_cast<float>(tile_.x1 - 1), bottom = static_cast<float>(tile_.y1 - 1);
        const PixelBox in_tile{max(box.x0, left), max(box.y0, top), min(box.x1, right), min(box.y1, bottom)};
        const Mask is_clipped = max(x1, y1) >= kFarAway;
        Mask live = ((in_tile.x0 <= in_tile.x1) & (in_tile.y0 <= in_tile.y1)) | is_clipped;
        live = live & first_lanes(section_.triangle_count - first);
        if (!any(live)) return;
        if (occlusion_ && !any(is_clipped & live) && hides(live, in_tile)) return;

        const Real columns = box.x1 - box.x0, rows = box.y1 - box.y0;
        constexpr float kMaximum = FittingTriangles::kMaxPixels - 1;
        const Mask fits = live & ~is_clipped & (columns <= kMaximum) & (rows <= kMaximum);
        constexpr float kOfBlock = Block::kSide - 1;
        if (any(fits)) draw_fitting(first, a, b, c, box, (columns <= kOfBlock) & (rows <= kOfBlock), fits);
        for (uint32_t rest = bits(live & ~fits); rest != 0; rest &= rest - 1)
            draw_one(first + static_cast<uint32_t>(__builtin_ctz(rest)));
    }

    INLINE bool hides(Mask live, const PixelBox& box) const {
        return occlusion_->hides(draw_, least(choose(live, box.x0, kFarAway)), least(choose(live, box.y0, kFarAway)),
                                 greatest(choose(live, box.x1, 0)), greatest(choose(live, box.y1, 0)));
    }

    // Draws triangles whose edges floats compute exactly (fitting.h). `is_small`: those in one block of samples, which
    // are tested in lanes; the rest are tested one after another.
    INLINE void draw_fitting(uint32_t first, const Corner& a, const Corner& b, const Corner& c, const PixelBox& box,
                             Mask is_small, Mask live) {
        const Real x1 = b.x - a.x, y1 = b.y - a.y, x2 = c.x - a.x, y2 = c.y - a.y;
        const Real area = x2 * y1 - x1 * y2;
        live = live & (area != 0);
        if (culls_) live = live & (draw_.is_mirrored ? area < 0 : area > 0);
        if (!any(live)) return;
        const Real side = choose(area < 0, 1.0f, -1.0f);
        const Real left = box.x0 * kSubpixels, top = box.y0 * kSubpixels;
        const LaneEdge edges[3]{{a.x, a.y, b.x, b.y, side, left, top},
                                {b.x, b.y, c.x, c.y, side, left, top},
                                {c.x, c.y, a.x, a.y, side, left, top}};
        is_small = is_small & live;
        const Whole samples = samples_of_block<kInto>(edges, box, tile_, is_small);
        const uint32_t small = bits(is_small), hit = bits(live & ~(is_small & (samples == 0)));
        if (hit == 0) return;

        const Real z[3]{gather(screen_.z, a.vertex), gather(screen_.z, b.vertex), gather(screen_.z, c.vertex)};
        const Plane<Real> planes = plane_of<kInto>(a.x, a.y, {x1, y1, x2, y2}, z, Real(-1) / area);
        uint32_t rest = hit;
        if constexpr (Of::kCount == 1 && !kMasked) {
            const Mask is_single = is_small & (samples > 0) & ((samples & (samples - 1)) == 0);
            write_singles(first, samples, box, planes, is_single);
            rest &= ~bits(is_single);
            if (rest == 0) return;
        }
        FittingTriangles triangles;
        triangles.set_planes(planes);
        triangles.set_box(box, samples);
        if ((rest & ~small) != 0) triangles.set_edges(edges);
        for (; rest != 0; rest &= rest - 1) {
            const int i = __builtin_ctz(rest);
            const Plane<float> plane = triangles.plane(i);
            const auto write = [&](int x, int y, uint32_t mask) {
                write_block(x, y, mask, plane, first + static_cast<uint32_t>(i));
            };
            if ((small >> i & 1) != 0)
                write(triangles.x0(i), triangles.y0(i), triangles.samples(i));
            else
                triangles.template for_blocks<kInto>(i, tile_, write);
        }
    }

    // Writes triangles that cover a single sample; their depths are computed in lanes. `samples`: the bit of that
    // sample in the block, whose pixels have one sample each.
    INLINE void write_singles(uint32_t first, Whole samples, const PixelBox& box, const Plane<Real>& planes,
                              Mask live) {
        const Whole place = (bits_of(Real(samples)) >> 23) - 127;  // the number of the bit, from the float's exponent
        const Real x = box.x0 + Real(place & 3), y = box.y0 + Real(place >> 2);
        alignas(64) float depths[Lanes::kCount];
        store(depths, planes.at(x * kSubpixels + Of::kX[0], y * kSubpixels + Of::kY[0]));
        uint32_t columns[Lanes::kCount], rows[Lanes::kCount];
        store_any(columns, truncated(x));
        store_any(rows, truncated(y));
        for (uint32_t rest = bits(live); rest != 0; rest &= rest - 1) {
            const auto i = static_cast<uint32_t>(__builtin_ctz(rest));
            target_.write(static_cast<int>(columns[i]), static_cast<int>(rows[i]), 0, depths[i],
                          draw_.first_id + first + i);
        }
    }

    INLINE void write_block(int x, int y, uint32_t mask, const Plane<float>& plane, uint32_t triangle) {
        if constexpr (kMasked) {
            constexpr uint32_t kOfPixel = (1u << Of::kCount) - 1;
            for (int pixel = 0; pixel < Block::kSide * Block::kSide; ++pixel)
                if (const uint32_t of_pixel = mask >> (pixel * Of::kCount) & kOfPixel)
                    fragments_.add(x + pixel % Block::kSide, y + pixel / Block::kSide, of_pixel, plane, triangle);
        } else {
            target_.write_block(x, y, mask, plane, draw_.first_id + triangle);
        }
    }

    // Draws one triangle of any size, clipped if necessary.
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
        const float* const at = draw_.vertices + place_of(vertex);
        const double x = double{at[0]}, y = double{at[kFour]}, z = double{at[2 * kFour]};
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
        const Plane<float> plane = plane_of<kInto>(t, area);
        fill<kInto>(t, tile_, area, [&](int x, int y, uint32_t mask) { write_block(x, y, mask, plane, triangle); });
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

INLINE bool lies_in(const float (&box)[4], const Tile& tile) {
    return box[2] >= static_cast<float>(tile.x0) && box[3] >= static_cast<float>(tile.y0) &&
           box[0] <= static_cast<float>(tile.x1) && box[1] <= static_cast<float>(tile.y1);
}

template <Into kInto>
void draw_triangles(const Frame& frame, const Tile& tile, const Draw& draw, const Screen& screen,
                    const Occlusion* occlusion) {
    project<kInto>(frame, draw, screen);
    if (draw.material->is_masked)
        DrawTriangles<kInto, true>(frame, tile, draw, screen, occlusion).run();
    else
        DrawTriangles<kInto, false>(frame, tile, draw, screen, occlusion).run();
}

// Zeroes the tile's part of each row; `columns`: pixels of a whole row.
template <class Item>
INLINE void clear(Item* items, uint32_t columns, uint32_t items_of_pixel, const Tile& tile) {
    for (uint32_t y = tile.y0; y < tile.y1; ++y)
        __builtin_memset(items + (size_t{y} * columns + tile.x0) * items_of_pixel, 0,
                         (tile.x1 - tile.x0) * items_of_pixel * sizeof(Item));
}

// Returns whether any draw lies in the tile.
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
