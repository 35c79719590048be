#include "draw/occluders.h"

#include "draw/descriptors.h"
#include "draw/pipeline.h"
#include "draw/rendering.h"

namespace throng {

Occluders::Occluders(std::shared_ptr<Gpu> gpu, uint32_t width, uint32_t height, VkSampleCountFlagBits samples)
    : gpu_(std::move(gpu)), width_(width), height_(height) {
    const bool several = samples != VK_SAMPLE_COUNT_1_BIT;
    depth_ = Image(gpu_,
                   {.what = "depths of occluders",
                    .width = width,
                    .height = height,
                    .format = kDepthFormat,
                    .usage = VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT |
                             VkImageUsageFlags{several ? VK_IMAGE_USAGE_SAMPLED_BIT : VK_IMAGE_USAGE_TRANSFER_SRC_BIT},
                    .samples = samples});
    if (!several) return;
    farthest_ = Image(gpu_, {.what = "farthest depths of occluders",
                             .width = width,
                             .height = height,
                             .format = kFarthestFormat,
                             .usage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT});
    VkSamplerCreateInfo nearest{VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO};  // the shader fetches
    sampler_ = OwnedSampler(gpu_, gpu_->vk.vkCreateSampler, nearest, "vkCreateSampler");
    const VkDescriptorSetLayoutBinding binding{0, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 1,
                                               VK_SHADER_STAGE_FRAGMENT_BIT, nullptr};
    VkDescriptorSetLayoutCreateInfo set_create{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO};
    set_create.bindingCount = 1;
    set_create.pBindings = &binding;
    set_layout_ = {gpu_, gpu_->vk.vkCreateDescriptorSetLayout, set_create, "vkCreateDescriptorSetLayout"};
    const VkDescriptorSetLayout set_layout = set_layout_.get();
    VkPipelineLayoutCreateInfo layout_create{VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO};
    layout_create.setLayoutCount = 1;
    layout_create.pSetLayouts = &set_layout;
    layout_ = {gpu_, gpu_->vk.vkCreatePipelineLayout, layout_create, "vkCreatePipelineLayout"};
    pipeline_ = make_farthest_pipeline(gpu_, layout_.get());

    pool_ = make_descriptor_pool(gpu_, 1, {{VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 1}});
    set_ = allocate_set(*gpu_, pool_, set_layout);
    write_image(*gpu_, set_, 0, {sampler_.get(), depth_.view(), VK_IMAGE_LAYOUT_DEPTH_READ_ONLY_OPTIMAL});
}

void Occluders::begin(VkCommandBuffer commands) const {
    transition(*gpu_, commands,
               {.image = depth_.handle(),
                .aspect = VK_IMAGE_ASPECT_DEPTH_BIT,
                .to = VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL,
                .before = kDepthAccess | kFragmentRead | kTransferRead,
                .after = kDepthAccess});
    const VkRenderingAttachmentInfo depth = depth_attachment(depth_, VK_ATTACHMENT_STORE_OP_STORE);
    begin_rendering(*gpu_, commands, {width_, height_}, nullptr, &depth);
}

void Occluders::end(VkCommandBuffer commands) const {
    gpu_->vk.vkCmdEndRendering(commands);
    transition(*gpu_, commands,
               {.image = depth_.handle(),
                .aspect = VK_IMAGE_ASPECT_DEPTH_BIT,
                .from = VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL,
                .to = has_samples() ? VK_IMAGE_LAYOUT_DEPTH_READ_ONLY_OPTIMAL : VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                .before = kDepthAccess,
                .after = has_samples() ? kFragmentRead : kTransferRead});
    if (has_samples()) resolve(commands);
}

void Occluders::resolve(VkCommandBuffer commands) const {
    transition(*gpu_, commands,
               {.image = farthest_.handle(),
                .to = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL,
                .before = kTransferRead,
                .after = kColorWrite});
    const VkRenderingAttachmentInfo color = color_attachment(farthest_, VK_ATTACHMENT_STORE_OP_STORE);
    begin_rendering(*gpu_, commands, {width_, height_}, &color, nullptr);
    gpu_->vk.vkCmdSetCullMode(commands, VK_CULL_MODE_NONE);
    gpu_->vk.vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline_.get());
    gpu_->vk.vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, layout_.get(), 0, 1, &set_, 0, nullptr);
    gpu_->vk.vkCmdDraw(commands, 3, 1, 0, 0);
    gpu_->vk.vkCmdEndRendering(commands);
    transition(*gpu_, commands,
               {.image = farthest_.handle(),
                .from = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL,
                .to = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                .before = kColorWrite,
                .after = kTransferRead});
}

DepthImage Occluders::depths() const {
    const Image& image = has_samples() ? farthest_ : depth_;
    return {.image = image.handle(),
            .aspect = VkImageAspectFlags{has_samples() ? VK_IMAGE_ASPECT_COLOR_BIT : VK_IMAGE_ASPECT_DEPTH_BIT},
            .width = width_,
            .height = height_,
            .reversed = true};
}

}  // namespace throng
