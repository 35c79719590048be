// The depths of a picture, prepared for testing what they hide.
#pragma once

#include "cull/cull.h"

#include <throng/crowd.h>

namespace throng {

// Depths of a picture, coarser from level to level.
class DepthPyramid {
public:
    // Has room for pictures of this size, and others of no more texels. Throws kLimit where the device cannot hold it
    // in one storage buffer.
    DepthPyramid(std::shared_ptr<Gpu> gpu, const Kernel& kernel, uint32_t width, uint32_t height);

    bool has_room_for(const DepthImage& depths) const;
    const Buffer& levels() const { return levels_; }
    uint64_t size_bytes() const { return picture_.size_bytes() + levels_.size_bytes(); }

    // Reads the image, and makes the pyramid visible to compute shaders.
    void record(VkCommandBuffer commands, const Kernel& kernel, const DepthImage& depths) const;

private:
    std::shared_ptr<Gpu> gpu_;
    Buffer picture_;  // float[height][width]
    Buffer levels_;   // cull/cull_io.h
    Bindings from_picture_, from_levels_;
};

}  // namespace throng
