#include "draw/image.h"

#include "base/failure.h"

namespace throng {
namespace {

VkImageAspectFlags aspect_of(VkFormat format) {
    return format == VK_FORMAT_D32_SFLOAT ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT;
}

}  // namespace

Image::Image(const std::shared_ptr<Gpu>& gpu, const ImageSettings& settings) {
    const auto [width, height] = settings.extent;
    const std::string size_text = std::to_string(width) + " x " + std::to_string(height);
    const uint32_t limit = gpu->properties.limits.maxImageDimension2D;
    if (width == 0 || height == 0)
        throw Failure(ErrorCode::kInvalidArgument, std::string(settings.what),
                      "the image is empty: " + size_text + " pixels");
    if (width > limit || height > limit)
        throw Failure(ErrorCode::kLimit, std::string(settings.what),
                      size_text + " exceeds the device's maxImageDimension2D of " + std::to_string(limit));

    const VkImageCreateInfo create{.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO,
                                   .imageType = VK_IMAGE_TYPE_2D,
                                   .format = settings.format,
                                   .extent = {width, height, 1},
                                   .mipLevels = settings.mip_count,
                                   .arrayLayers = 1,
                                   .samples = settings.samples,
                                   .tiling = VK_IMAGE_TILING_OPTIMAL,
                                   .usage = settings.usage};
    try {
        image_ = OwnedImage(gpu, gpu->vk.vkCreateImage, create, "vkCreateImage");
        VkMemoryRequirements needs{};
        gpu->vk.vkGetImageMemoryRequirements(gpu->device, image_.get(), &needs);
        if (needs.size > gpu->max_allocation_bytes)
            throw Failure(ErrorCode::kLimit, {},
                          std::to_string(needs.size) + " bytes exceed the device's largest allocation of " +
                              std::to_string(gpu->max_allocation_bytes));
        gpu->allocate(needs.memoryTypeBits, 0, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, [&](uint32_t type) {
            const VkMemoryAllocateInfo allocate{
                .sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, .allocationSize = needs.size, .memoryTypeIndex = type};
            memory_ = OwnedMemory(gpu, gpu->vk.vkAllocateMemory, allocate, "vkAllocateMemory");
        });
        check(gpu->vk.vkBindImageMemory(gpu->device, image_.get(), memory_.get(), 0), "vkBindImageMemory");
        constexpr VkImageUsageFlags kCopied = VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT;
        if ((settings.usage & ~kCopied) == 0) return;
        const VkImageViewCreateInfo view_create{
            .sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
            .image = image_.get(),
            .viewType = VK_IMAGE_VIEW_TYPE_2D,
            .format = settings.format,
            .subresourceRange = {aspect_of(settings.format), 0, settings.mip_count, 0, 1}};
        view_ = OwnedImageView(gpu, gpu->vk.vkCreateImageView, view_create, "vkCreateImageView");
    } catch (const Failure& failure) {
        throw Failure(failure.error.code, std::string(settings.what) + " (" + size_text + ")", failure.error.message);
    }
}

void transition(const Gpu& gpu, VkCommandBuffer commands, VkImage image, const ImageUse& from, const ImageUse& to,
                uint32_t first_mip, uint32_t mip_count) {
    const auto is_of_depths = [](const ImageUse& use) {
        return use.layout == kDepthTarget.layout || use.layout == kDepthTexture.layout;
    };
    const VkImageAspectFlags aspect = is_of_depths(from) || is_of_depths(to) ? VK_IMAGE_ASPECT_DEPTH_BIT
                                                                             : VK_IMAGE_ASPECT_COLOR_BIT;
    const VkImageMemoryBarrier2 barrier{.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2,
                                        .srcStageMask = from.access.stage,
                                        .srcAccessMask = from.access.access,
                                        .dstStageMask = to.access.stage,
                                        .dstAccessMask = to.access.access,
                                        .oldLayout = from.layout,
                                        .newLayout = to.layout,
                                        .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                                        .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                                        .image = image,
                                        .subresourceRange = {aspect, first_mip, mip_count, 0, 1}};
    const VkDependencyInfo dependency{
        .sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO, .imageMemoryBarrierCount = 1, .pImageMemoryBarriers = &barrier};
    gpu.vk.vkCmdPipelineBarrier2(commands, &dependency);
}

VkRenderingAttachmentInfo attachment(const Image& image, const ImageUse& use, VkAttachmentLoadOp load,
                                     VkAttachmentStoreOp store) {
    return {.sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO,
            .imageView = image.view(),
            .imageLayout = use.layout,
            .loadOp = load,
            .storeOp = store};
}

void begin_rendering(const Gpu& gpu, VkCommandBuffer commands, const VkExtent2D& extent,
                     const VkRenderingAttachmentInfo* color, const VkRenderingAttachmentInfo* depth) {
    const VkRenderingInfo rendering{.sType = VK_STRUCTURE_TYPE_RENDERING_INFO,
                                    .renderArea = {{0, 0}, extent},
                                    .layerCount = 1,
                                    .colorAttachmentCount = color ? 1u : 0u,
                                    .pColorAttachments = color,
                                    .pDepthAttachment = depth};
    gpu.vk.vkCmdBeginRendering(commands, &rendering);
    const VkViewport viewport{0, 0, static_cast<float>(extent.width), static_cast<float>(extent.height), 0, 1};
    gpu.vk.vkCmdSetViewport(commands, 0, 1, &viewport);
    gpu.vk.vkCmdSetScissor(commands, 0, 1, &rendering.renderArea);
}

OwnedSampler make_nearest_sampler(const std::shared_ptr<Gpu>& gpu) {
    const VkSamplerCreateInfo nearest{.sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO};
    return {gpu, gpu->vk.vkCreateSampler, nearest, "vkCreateSampler"};
}

}  // namespace throng
