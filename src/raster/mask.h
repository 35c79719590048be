// The alpha of masked and blended triangles.
#pragma once

#include "raster/interpolation.h"
#include "raster/sample.h"

namespace throng::raster {
namespace {

// Alphas of the draw's triangles, at the centres of pixels of the picture, or texels of the map.
INLINE Real alphas_of(const Frame& frame, const Draw& draw, bool is_map, Whole triangles, Whole x, Whole y) {
    const Section& section = *draw.section;
    const Material& material = *draw.material;
    ClipPoint corners[3];
    Real of_corners[3];
    vec2 texcoords[3];
    for (int k = 0; k < 3; ++k) {
        const Whole vertex = gather(section.corners[k], triangles);
        constexpr int32_t kWithin = kFour - 1, kFloatsEach = kFourFloats / kFour;
        const Whole at = (vertex & ~kWithin) * kFloatsEach + (vertex & kWithin);
        const vec3 world(gather(draw.vertices, at), gather(draw.vertices + kFour, at),
                         gather(draw.vertices + 2 * kFour, at));
        corners[k] = is_map ? to_map(frame.scene, world) : to_picture(frame.scene, world);
        of_corners[k] = unpacked_color(gather(section.colors, vertex)).w;
        texcoords[k] = {gather(section.texcoords, vertex << 1), gather(section.texcoords + 1, vertex << 1)};
    }
    // The map reaches from 0 to 1, the picture from -1 to 1
    const float pixel_x = is_map ? 1 / static_cast<float>(frame.map_size) : 2 / static_cast<float>(frame.width),
                pixel_y = is_map ? pixel_x : 2 / static_cast<float>(frame.height), least = is_map ? 0.0f : -1.0f;
    const Interpolation point(corners, (Real(x) + 0.5f) * pixel_x + least, (Real(y) + 0.5f) * pixel_y + least);
    Real alpha = material.base_color[3] * point.at(of_corners);
    if (material.base_color_map) {
        const Texture& texture = *material.base_color_map;
        const Real mip = mip_of(texture, point.step_x(pixel_x).sum(texcoords), point.step_y(pixel_y).sum(texcoords));
        alpha *= sampled(texture, material.sampling, point.at(texcoords), mip).w;
    }
    return alpha;
}

}  // namespace
}  // namespace throng::raster
