// The light, computed in lanes by the shaders' source.
#pragma once

#include "raster/frame.h"
#include "raster/lane_vectors.h"

// The shaders convert numbers implicitly and shadow names.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wfloat-conversion"
#pragma GCC diagnostic ignored "-Wshadow"

namespace throng::raster {
namespace {

// io::DrawScene once more: the numbers of raster::Scene by the names that the shaders use.
struct TextScene {
    Numbers clip_from_world[4], map_from_world[3];
    Numbers eye, forward, right, down, to_sun, ground, fog, picture, shadow, map_grid;
    Numbers sun_light, sky_light, bounce_light, horizon, zenith, ground_albedo;
};
static_assert(sizeof(TextScene) == sizeof(Scene));
INLINE TextScene text_scene(const Frame& frame) {
    TextScene scene;
    __builtin_memcpy(&scene, &frame.scene, sizeof scene);
    return scene;
}

struct LightText {
    using uint = Word;

    const TextScene& scene;
    const float* map;
    const uint32_t* casters;  // as Frame::casters

    INLINE Mask has_heights(Whole column, Whole row) const {
        if (!casters) return first_lanes(Lanes::kCount);
        const auto size = static_cast<uint32_t>(scene.shadow.x);
        const auto count = static_cast<int32_t>(cells_of_map(size));
        const auto cell = [&](Whole texel) { return clamp(texel >> kCellShift, 0, count - 1); };
        return Whole(0) < gather(casters, cell(row) * count + cell(column));
    }
    INLINE vec4 heights_at(Whole column, Whole row) const {
        const auto size = static_cast<int32_t>(scene.shadow.x);
        const Whole first = row * size;
        // For columns farther outside, sun_at() ignores what is read
        const Mask at_edge = ((column > -4) & (column < 0)) | ((column > size - 4) & (column < size));
        Real of[4];
        if (!any(at_edge))
            gather_fours(map, first + clamp(column, 0, size - 4), of[0], of[1], of[2], of[3]);
        else
            for (int i = 0; i < 4; ++i) of[i] = gather(map, first + clamp(column + i, 0, size - 1));
        return {of[0], of[1], of[2], of[3]};
    }

#include "draw/ground_model.glsl"
#include "draw/light_model.glsl"
#include "draw/material_model.glsl"
#include "draw/sun_model.glsl"
};

}  // namespace
}  // namespace throng::raster

#pragma GCC diagnostic pop
