// The render targets of a picture: colour and depth, with several samples if the device has them, and the resolved
// picture.
#pragma once

#include "draw/image.h"
#include "gpu/buffer.h"

#include <throng/draw.h>

namespace throng {

class Targets {
public:
    Targets() = default;
    // Throws kLimit where the device cannot draw so large a picture.
    Targets(std::shared_ptr<Gpu> gpu, VkExtent2D extent, VkSampleCountFlagBits samples, bool blue_first);

    // Begins the render pass: color is undefined, depth infinitely far. Waits for earlier draws to the targets and
    // copies from them.
    void begin(VkCommandBuffer commands) const;
    // Ends it. The picture is then in TRANSFER_SRC_OPTIMAL, visible to transfers.
    void end(VkCommandBuffer commands) const;
    // After end(): copies the picture to where read_back() finds it once the commands have run. Call make_read_back()
    // first.
    void record_read_back(VkCommandBuffer commands) const;
    void make_read_back();
    Picture read_back() const;

    VkImage picture() const { return (resolved_.handle() ? resolved_ : color_).handle(); }
    const VkExtent2D& extent() const { return extent_; }

private:
    std::shared_ptr<Gpu> gpu_;
    VkExtent2D extent_{};
    bool blue_first_ = false;
    Image color_, depth_;
    Image resolved_;  // of color_, where that has several samples
    Buffer read_back_;
};

}  // namespace throng
