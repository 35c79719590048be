#include "draw/depth_pass.h"

#include "draw/pipeline.h"

namespace throng {

DepthPass::DepthPass(std::shared_ptr<Gpu> gpu, std::string_view what, VkExtent2D extent, VkSampleCountFlagBits samples,
                     const ImageUse& after)
    : gpu_(std::move(gpu)), extent_(extent), after_(after), sampler_(make_nearest_sampler(gpu_)) {
    const VkImageUsageFlagBits read = after.layout == kDepthTexture.layout ? VK_IMAGE_USAGE_SAMPLED_BIT
                                                                           : VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
    image_ = Image(gpu_, {.what = what,
                          .extent = extent,
                          .format = kDepthFormat,
                          .usage = VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT | VkImageUsageFlags{read},
                          .samples = samples});
}

void DepthPass::begin(VkCommandBuffer commands) const {
    transition(*gpu_, commands, image(), discarded_after(kDepthAccess | after_.access), kDepthTarget);
    const VkRenderingAttachmentInfo depth = attachment(image_, kDepthTarget, VK_ATTACHMENT_LOAD_OP_CLEAR,
                                                       VK_ATTACHMENT_STORE_OP_STORE);
    begin_rendering(*gpu_, commands, extent_, nullptr, &depth);
}

void DepthPass::end(VkCommandBuffer commands) const {
    gpu_->vk.vkCmdEndRendering(commands);
    transition(*gpu_, commands, image(), kDepthTarget, after_);
}

}  // namespace throng
