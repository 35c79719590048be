#include "draw/occluders.h"

#include "draw/pipeline.h"

namespace throng {

Occluders::Occluders(std::shared_ptr<Gpu> gpu, VkExtent2D extent, VkSampleCountFlagBits samples)
    : gpu_(std::move(gpu)),
      pass_(gpu_, "depths of occluders", extent, samples,
            samples == VK_SAMPLE_COUNT_1_BIT ? kCopySource : kDepthTexture) {
    if (samples == VK_SAMPLE_COUNT_1_BIT) return;
    farthest_ = Image(gpu_, {.what = "farthest depths of occluders",
                             .extent = extent,
                             .format = kFarthestFormat,
                             .usage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT});
    layout_ = make_farthest_layout(gpu_);
    pipeline_ = make_farthest_pipeline(gpu_, layout_);
    const VkDescriptorImageInfo depths = pass_.texture();
    bindings_ = Bindings(gpu_, "farthest", layout_.set(0), {}, {&depths, 1});
}

void Occluders::end(VkCommandBuffer commands) const {
    pass_.end(commands);
    if (has_samples()) resolve(commands);
}

void Occluders::resolve(VkCommandBuffer commands) const {
    const VkDescriptorSet set = bindings_.set();
    const VkRenderingAttachmentInfo color = attachment(farthest_, kColorTarget, VK_ATTACHMENT_LOAD_OP_DONT_CARE,
                                                       VK_ATTACHMENT_STORE_OP_STORE);
    transition(*gpu_, commands, farthest_.handle(), discarded_after(kTransferRead), kColorTarget);
    begin_rendering(*gpu_, commands, pass_.extent(), &color, nullptr);
    gpu_->vk.vkCmdSetCullMode(commands, VK_CULL_MODE_NONE);
    gpu_->vk.vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline_.get());
    gpu_->vk.vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, layout_.get(), 0, 1, &set, 0, nullptr);
    gpu_->vk.vkCmdDraw(commands, 3, 1, 0, 0);
    gpu_->vk.vkCmdEndRendering(commands);
    transition(*gpu_, commands, farthest_.handle(), kColorTarget, kCopySource);
}

DepthImage Occluders::depths() const {
    return {.image = has_samples() ? farthest_.handle() : pass_.image(),
            .aspect = VkImageAspectFlags{has_samples() ? VK_IMAGE_ASPECT_COLOR_BIT : VK_IMAGE_ASPECT_DEPTH_BIT},
            .width = pass_.extent().width,
            .height = pass_.extent().height,
            .reversed = true};
}

}  // namespace throng
