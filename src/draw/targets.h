// What a picture is drawn into: colour and depth, of several samples where the device has them, and the picture that
// they end as.
#pragma once

#include "draw/image.h"
#include "gpu/buffer.h"

#include <throng/draw.h>

namespace throng {

class Targets {
public:
    Targets() = default;
    // Throws kLimit where the device cannot draw so large a picture.
    Targets(std::shared_ptr<Gpu> gpu, uint32_t width, uint32_t height, VkSampleCountFlagBits samples);

    // Begins the render pass: color is undefined, depth infinitely far. Waits for whoever draws to the targets, or
    // copies from them, before.
    void begin(VkCommandBuffer commands) const;
    // Ends it. The picture is then in TRANSFER_SRC_OPTIMAL, visible to transfers.
    void end(VkCommandBuffer commands) const;
    // Then copies the picture to where read_back() finds it, once the commands have run.
    void record_read_back(VkCommandBuffer commands);
    Picture read_back() const;

    VkImage picture() const { return (resolved_.handle() ? resolved_ : color_).handle(); }
    uint32_t width() const { return width_; }
    uint32_t height() const { return height_; }
    VkExtent2D extent() const { return {width_, height_}; }

private:
    std::shared_ptr<Gpu> gpu_;
    uint32_t width_ = 0, height_ = 0;
    Image color_, depth_;
    Image resolved_;    // of color_, where that has several samples
    Buffer read_back_;  // made when first needed
};

}  // namespace throng
