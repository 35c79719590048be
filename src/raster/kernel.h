// The whole kernel, for any instruction set. Include a native/lanes_*.h, which defines Lanes, first.
#pragma once

#include "raster/draw.h"
#include "raster/resolve.h"
#include "raster/skin.h"

namespace throng::raster {
namespace {

size_t scratch_bytes(const Frame& frame) {
    const size_t draws = scratch_bytes_to_draw(frame), resolves = sizeof(Span);
    return draws > resolves ? draws : resolves;
}

constexpr Kernel make_kernel() { return {place, skin, keep, scratch_bytes, draw_map, draw_picture, resolve}; }

}  // namespace
}  // namespace throng::raster
