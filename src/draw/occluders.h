// Depths of what was visible in the last frame: what hides the rest (Crowd::record_disoccluded).
#pragma once

#include "draw/image.h"

#include <throng/crowd.h>

namespace throng {

class Occluders {
public:
    // Of as many samples as the picture has: what shows at one of them alone hides nothing.
    Occluders(std::shared_ptr<Gpu> gpu, uint32_t width, uint32_t height, VkSampleCountFlagBits samples);

    // Begins and ends the pass that draws depths, infinitely far where nothing is drawn.
    void begin(VkCommandBuffer commands) const;
    void end(VkCommandBuffer commands) const;
    // Then the farthest depth of each pixel's samples.
    DepthImage depths() const;

private:
    void resolve(VkCommandBuffer commands) const;
    bool has_samples() const { return farthest_.handle() != VK_NULL_HANDLE; }

    std::shared_ptr<Gpu> gpu_;
    uint32_t width_, height_;
    Image depth_;
    // Where it has several samples:
    Image farthest_;
    OwnedSampler sampler_;
    OwnedSetLayout set_layout_;
    OwnedPipelineLayout layout_;
    OwnedPipeline pipeline_;
    OwnedPool pool_;
    VkDescriptorSet set_ = VK_NULL_HANDLE;
};

}  // namespace throng
