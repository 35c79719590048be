// Depths, in this frame, of the instances that were visible in the last one. They hide other instances
// (Crowd::record_disoccluded).
#pragma once

#include "draw/depth_pass.h"
#include "gpu/shader.h"

#include <throng/crowd.h>

namespace throng {

class Occluders {
public:
    // Has as many samples as the picture, so that geometry that covers only some of a pixel's samples hides nothing.
    Occluders(std::shared_ptr<Gpu> gpu, VkExtent2D extent, VkSampleCountFlagBits samples);

    // Begins and ends the pass that draws depths.
    void begin(VkCommandBuffer commands) const { pass_.begin(commands); }
    void end(VkCommandBuffer commands) const;
    // After end(): the farthest depth of each pixel's samples.
    DepthImage depths() const;

private:
    void resolve(VkCommandBuffer commands) const;
    bool has_samples() const { return farthest_.handle() != VK_NULL_HANDLE; }

    std::shared_ptr<Gpu> gpu_;
    DepthPass pass_;
    // Only if there are several samples:
    Image farthest_;
    ShaderLayout layout_;
    OwnedPipeline pipeline_;
    Bindings bindings_;
};

}  // namespace throng
