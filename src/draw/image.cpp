#include "draw/image.h"

#include "base/failure.h"

namespace throng {
namespace {

VkImageAspectFlags aspect_of(VkFormat format) {
    return format == VK_FORMAT_D32_SFLOAT ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT;
}

}  // namespace

Image::Image(const std::shared_ptr<Gpu>& gpu, const ImageSettings& settings) {
    const std::string size_text = std::to_string(settings.width) + " x " + std::to_string(settings.height);
    const uint32_t limit = gpu->properties.limits.maxImageDimension2D;
    if (settings.width == 0 || settings.height == 0)
        throw Failure(ErrorCode::kInvalidArgument, std::string(settings.what), size_text + " is empty");
    if (settings.width > limit || settings.height > limit)
        throw Failure(ErrorCode::kLimit, std::string(settings.what),
                      size_text + " exceeds the device's maxImageDimension2D of " + std::to_string(limit));

    VkImageCreateInfo create{VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO};
    create.imageType = VK_IMAGE_TYPE_2D;
    create.format = settings.format;
    create.extent = {settings.width, settings.height, 1};
    create.mipLevels = settings.mip_count;
    create.arrayLayers = 1;
    create.samples = settings.samples;
    create.tiling = VK_IMAGE_TILING_OPTIMAL;
    create.usage = settings.usage;
    create.sharingMode = VK_SHARING_MODE_EXCLUSIVE;
    create.initialLayout = VK_IMAGE_LAYOUT_UNDEFINED;
    try {
        image_ = OwnedImage(gpu, gpu->vk.vkCreateImage, create, "vkCreateImage");
        VkMemoryRequirements needs{};
        gpu->vk.vkGetImageMemoryRequirements(gpu->device, image_.get(), &needs);
        if (needs.size > gpu->max_allocation_bytes)
            throw Failure(ErrorCode::kLimit, {},
                          std::to_string(needs.size) + " bytes exceed the device's largest allocation of " +
                              std::to_string(gpu->max_allocation_bytes));
        VkMemoryAllocateInfo allocate{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO};
        allocate.allocationSize = needs.size;
        allocate.memoryTypeIndex = gpu->memory_type(needs.memoryTypeBits, 0, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT);
        memory_ = OwnedMemory(gpu, gpu->vk.vkAllocateMemory, allocate, "vkAllocateMemory");
        check(gpu->vk.vkBindImageMemory(gpu->device, image_.get(), memory_.get(), 0), "vkBindImageMemory");
        VkImageViewCreateInfo view_create{VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO};
        view_create.image = image_.get();
        view_create.viewType = VK_IMAGE_VIEW_TYPE_2D;
        view_create.format = settings.format;
        view_create.subresourceRange = {aspect_of(settings.format), 0, settings.mip_count, 0, 1};
        view_ = OwnedImageView(gpu, gpu->vk.vkCreateImageView, view_create, "vkCreateImageView");
    } catch (const Failure& failure) {
        throw Failure(failure.error.code, std::string(settings.what) + " (" + size_text + ")", failure.error.message);
    }
}

void transition(const Gpu& gpu, VkCommandBuffer commands, const Transition& t) {
    VkImageMemoryBarrier2 barrier{VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2};
    barrier.srcStageMask = t.before.stage;
    barrier.srcAccessMask = t.before.access;
    barrier.dstStageMask = t.after.stage;
    barrier.dstAccessMask = t.after.access;
    barrier.oldLayout = t.from;
    barrier.newLayout = t.to;
    barrier.srcQueueFamilyIndex = barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
    barrier.image = t.image;
    barrier.subresourceRange = {t.aspect, t.first_mip, t.mip_count, 0, 1};
    VkDependencyInfo dependency{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
    dependency.imageMemoryBarrierCount = 1;
    dependency.pImageMemoryBarriers = &barrier;
    gpu.vk.vkCmdPipelineBarrier2(commands, &dependency);
}

}  // namespace throng
