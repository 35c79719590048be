#include "draw/targets.h"

#include "base/failure.h"
#include "draw/pipeline.h"
#include "draw/rendering.h"

namespace throng {

Targets::Targets(std::shared_ptr<Gpu> gpu, uint32_t width, uint32_t height, VkSampleCountFlagBits samples)
    : gpu_(std::move(gpu)), width_(width), height_(height) {
    const VkPhysicalDeviceLimits& limits = gpu_->properties.limits;
    if (width > limits.maxFramebufferWidth || height > limits.maxFramebufferHeight)
        throw Failure(ErrorCode::kLimit, "picture",
                      std::to_string(width) + " x " + std::to_string(height) +
                          " exceeds the device's largest framebuffer of " + std::to_string(limits.maxFramebufferWidth) +
                          " x " + std::to_string(limits.maxFramebufferHeight));
    constexpr VkImageUsageFlags kPictureUsage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
    color_ = Image(gpu_, {.what = "picture",
                          .width = width,
                          .height = height,
                          .format = kColorFormat,
                          .usage = kPictureUsage,
                          .samples = samples});
    depth_ = Image(gpu_, {.what = "depth",
                          .width = width,
                          .height = height,
                          .format = kDepthFormat,
                          .usage = VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT,
                          .samples = samples});
    if (samples != VK_SAMPLE_COUNT_1_BIT)
        resolved_ = Image(gpu_, {.what = "resolved picture",
                                 .width = width,
                                 .height = height,
                                 .format = kColorFormat,
                                 .usage = kPictureUsage});
}

void Targets::begin(VkCommandBuffer commands) const {
    const auto prepare = [&](const Image& image, VkImageAspectFlags aspect, VkImageLayout layout, Access before,
                             Access access) {
        transition(*gpu_, commands,
                   {.image = image.handle(), .aspect = aspect, .to = layout, .before = before, .after = access});
    };
    prepare(color_, VK_IMAGE_ASPECT_COLOR_BIT, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL, kColorWrite | kTransferRead,
            kColorWrite);
    prepare(depth_, VK_IMAGE_ASPECT_DEPTH_BIT, VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL, kDepthAccess, kDepthAccess);
    const bool resolves = resolved_.handle() != VK_NULL_HANDLE;
    if (resolves)
        prepare(resolved_, VK_IMAGE_ASPECT_COLOR_BIT, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL,
                kColorWrite | kTransferRead, kColorWrite);

    // The ground covers all of it
    VkRenderingAttachmentInfo color = color_attachment(
        color_, resolves ? VK_ATTACHMENT_STORE_OP_DONT_CARE : VK_ATTACHMENT_STORE_OP_STORE);
    if (resolves) {
        color.resolveMode = VK_RESOLVE_MODE_AVERAGE_BIT;
        color.resolveImageView = resolved_.view();
        color.resolveImageLayout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
    }
    const VkRenderingAttachmentInfo depth = depth_attachment(depth_, VK_ATTACHMENT_STORE_OP_DONT_CARE);
    begin_rendering(*gpu_, commands, extent(), &color, &depth);
}

void Targets::end(VkCommandBuffer commands) const {
    gpu_->vk.vkCmdEndRendering(commands);
    transition(*gpu_, commands,
               {.image = picture(),
                .from = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL,
                .to = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                .before = kColorWrite,
                .after = kTransferRead});
}

void Targets::record_read_back(VkCommandBuffer commands) {
    if (!read_back_.handle())
        read_back_ = Buffer(gpu_, "picture read-back", uint64_t{width_} * height_ * 4, 0, MemoryKind::kReadback);
    VkBufferImageCopy copy{};
    copy.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
    copy.imageExtent = {width_, height_, 1};
    gpu_->vk.vkCmdCopyImageToBuffer(commands, picture(), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, read_back_.handle(), 1,
                                    &copy);
    memory_barrier(*gpu_, commands, kTransferWrite, kHostRead);
}

Picture Targets::read_back() const {
    Picture picture{.width = width_, .height = height_};
    const auto* bytes = reinterpret_cast<const uint8_t*>(read_back_.mapped());
    picture.rgba.assign(bytes, bytes + read_back_.size_bytes());
    return picture;
}

}  // namespace throng
