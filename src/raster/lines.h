// The lines of a picture, as triangles.
#pragma once

#include "raster/clip.h"

namespace throng::raster {
namespace {

template <Into kInto>
void draw_lines(const Frame& frame, const Tile& tile) {
    const Target<kInto> target(frame, tile);
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
                const Plane<float> plane = plane_of<kInto>(t, area);
                fill<kInto>(t, tile, area, [&](int x, int y, uint32_t mask) {
                    target.write_block(x, y, mask, plane, frame.first_line_id + 2 * i + half);
                });
            });
        }
    }
}

}  // namespace
}  // namespace throng::raster
