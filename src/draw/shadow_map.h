// What the sun sees: a map of heights towards it, fitted to what the camera sees of the crowd.
#pragma once

#include "draw/camera.h"
#include "draw/depth_pass.h"

namespace throng {

struct ShadowFit {
    // rows: place in the map and height towards the sun, all 0..1
    std::array<std::array<float, 4>, 3> map_from_world{};
    std::array<float, 2> grid{};  // io::DrawScene::map_grid
    float texel = 0;              // world size of the larger side of one
};

// Fits the map to what the camera may see in shadow and to what casts those shadows: seen along the sun's rays, the
// part of `posed` that overlaps the view, which ends where no shadow of `posed` falls any more. In height it holds all
// of `posed`. The map moves in whole texels, so that shadows do not crawl while the camera moves.
ShadowFit fit_shadow(const Camera& camera, const View& view, const Bounds& posed, const Vec3<float>& to_sun,
                     uint32_t map_size);

// The map's size, each way: as many texels as the picture's larger side has samples, at least 512 and at most 4096.
uint32_t shadow_map_size(const VkExtent2D& picture, uint32_t samples);

// The map itself, which fragment shaders read.
DepthPass make_shadow_map(const std::shared_ptr<Gpu>& gpu, const VkExtent2D& picture, uint32_t samples);

}  // namespace throng
