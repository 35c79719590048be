// A render pass that draws only depth: the shadow map, or the depths of occluders.
#pragma once

#include "draw/image.h"

namespace throng {

class DepthPass {
public:
    DepthPass() = default;
    // `what` names the depths in messages; `after`: what they are used for after the pass.
    DepthPass(std::shared_ptr<Gpu> gpu, std::string_view what, VkExtent2D extent, VkSampleCountFlagBits samples,
              const ImageUse& after);

    // Clears depths to 0: infinitely far from a camera, lowest towards the sun. Waits for earlier uses of the depths.
    void begin(VkCommandBuffer commands) const;
    void end(VkCommandBuffer commands) const;

    VkImage image() const { return image_.handle(); }
    // For shaders that fetch single texels, with kDepthTexture.
    VkDescriptorImageInfo texture() const { return {sampler_.get(), image_.view(), kDepthTexture.layout}; }
    const VkExtent2D& extent() const { return extent_; }

private:
    std::shared_ptr<Gpu> gpu_;
    VkExtent2D extent_{};
    ImageUse after_{};
    Image image_;
    OwnedSampler sampler_;
};

}  // namespace throng
