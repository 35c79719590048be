// What the sun sees: a map of heights towards it, fitted to what the camera sees of the crowd.
#pragma once

#include "draw/camera.h"
#include "draw/image.h"

namespace throng {

struct ShadowFit {
    // rows: place in the map and height towards the sun, all 0..1
    std::array<std::array<float, 4>, 3> map_from_world{};
    float texel = 0;  // world size of the larger side of one
};

// Holds everything that the camera may see in shadow, and all that throws it: the bounds of the crowd, in all its
// poses, as far as the picture reaches along the sun's rays. It depends on nothing else, and moves in whole texels, so
// that shadows do not crawl while the camera does.
ShadowFit fit_shadow(const Camera& camera, const View& view, const Bounds& posed, const Vec3<float>& to_sun,
                     uint32_t map_size);

class ShadowMap {
public:
    ShadowMap() = default;
    // Two texels for each pixel of the picture's larger side, to a power of two.
    ShadowMap(std::shared_ptr<Gpu> gpu, uint32_t picture_width, uint32_t picture_height);

    // Begins the render pass of depth alone, 0 everywhere, and ends it: then fragment shaders may read the map.
    void begin(VkCommandBuffer commands) const;
    void end(VkCommandBuffer commands) const;

    VkImageView view() const { return image_.view(); }
    uint32_t size() const { return size_; }

private:
    std::shared_ptr<Gpu> gpu_;
    uint32_t size_ = 0;  // texels, each way
    Image image_;
};

}  // namespace throng
