#include "draw/targets.h"

#include "base/failure.h"
#include "draw/pipeline.h"

namespace throng {

Targets::Targets(std::shared_ptr<Gpu> gpu, VkExtent2D extent, VkSampleCountFlagBits samples, bool blue_first)
    : gpu_(std::move(gpu)), extent_(extent), blue_first_(blue_first) {
    const VkPhysicalDeviceLimits& limits = gpu_->properties.limits;
    if (extent.width > limits.maxFramebufferWidth || extent.height > limits.maxFramebufferHeight)
        throw Failure(ErrorCode::kLimit, "picture",
                      std::to_string(extent.width) + " x " + std::to_string(extent.height) +
                          " exceeds the device's largest framebuffer of " + std::to_string(limits.maxFramebufferWidth) +
                          " x " + std::to_string(limits.maxFramebufferHeight));
    ImageSettings settings{.what = "picture",
                           .extent = extent,
                           .format = color_format(blue_first),
                           .usage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT,
                           .samples = samples};
    color_ = Image(gpu_, settings);
    if (samples != VK_SAMPLE_COUNT_1_BIT) {
        settings.what = "resolved picture";
        settings.samples = VK_SAMPLE_COUNT_1_BIT;
        resolved_ = Image(gpu_, settings);
    }
    depth_ = Image(gpu_, {.what = "depth",
                          .extent = extent,
                          .format = kDepthFormat,
                          .usage = VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT,
                          .samples = samples});
}

void Targets::begin(VkCommandBuffer commands) const {
    const ImageUse shown_before = discarded_after(kColorWrite | kTransferRead);
    const bool resolves = resolved_.handle() != VK_NULL_HANDLE;
    transition(*gpu_, commands, color_.handle(), shown_before, kColorTarget);
    transition(*gpu_, commands, depth_.handle(), discarded_after(kDepthAccess), kDepthTarget);
    if (resolves) transition(*gpu_, commands, resolved_.handle(), shown_before, kColorTarget);

    // The ground covers all of it
    VkRenderingAttachmentInfo color = attachment(
        color_, kColorTarget, VK_ATTACHMENT_LOAD_OP_DONT_CARE,
        resolves ? VK_ATTACHMENT_STORE_OP_DONT_CARE : VK_ATTACHMENT_STORE_OP_STORE);
    if (resolves) {
        color.resolveMode = VK_RESOLVE_MODE_AVERAGE_BIT;
        color.resolveImageView = resolved_.view();
        color.resolveImageLayout = kColorTarget.layout;
    }
    const VkRenderingAttachmentInfo depth = attachment(depth_, kDepthTarget, VK_ATTACHMENT_LOAD_OP_CLEAR,
                                                       VK_ATTACHMENT_STORE_OP_DONT_CARE);
    begin_rendering(*gpu_, commands, extent_, &color, &depth);
}

void Targets::end(VkCommandBuffer commands) const {
    gpu_->vk.vkCmdEndRendering(commands);
    transition(*gpu_, commands, picture(), kColorTarget, kCopySource);
}

void Targets::make_read_back() {
    if (!read_back_.handle())
        read_back_ = Buffer(gpu_, "picture read-back", uint64_t{extent_.width} * extent_.height * 4, 0,
                            MemoryKind::kReadback);
}

void Targets::record_read_back(VkCommandBuffer commands) const {
    const VkBufferImageCopy copy{.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                                 .imageExtent = {extent_.width, extent_.height, 1}};
    gpu_->vk.vkCmdCopyImageToBuffer(commands, picture(), kCopySource.layout, read_back_.handle(), 1, &copy);
    memory_barrier(*gpu_, commands, kTransferWrite, kHostRead);
}

Picture Targets::read_back() const {
    const auto* bytes = reinterpret_cast<const uint8_t*>(read_back_.mapped());
    Picture picture{extent_.width, extent_.height, {bytes, bytes + read_back_.size_bytes()}};
    if (blue_first_)
        for (size_t i = 0; i < picture.rgba.size(); i += 4) std::swap(picture.rgba[i], picture.rgba[i + 2]);
    return picture;
}

}  // namespace throng
