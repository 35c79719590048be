#include "tools/view/swapchain.h"

#include "tools/cli/command.h"

#include <algorithm>

namespace throng::view {
namespace {

// Eight bits a channel whose bytes are written as they are: the picture's are sRGB already.
VkSurfaceFormatKHR find_format(const Context& context) {
    const auto formats = list_of<VkSurfaceFormatKHR>("vkGetPhysicalDeviceSurfaceFormatsKHR",
                                                     vkGetPhysicalDeviceSurfaceFormatsKHR, context.physical_device(),
                                                     context.surface());
    const auto found = std::find_if(formats.begin(), formats.end(), [](const VkSurfaceFormatKHR& format) {
        return (format.format == VK_FORMAT_B8G8R8A8_UNORM || format.format == VK_FORMAT_R8G8B8A8_UNORM) &&
               format.colorSpace == VK_COLOR_SPACE_SRGB_NONLINEAR_KHR;
    });
    if (found == formats.end())
        throw tools::CommandError(
            "the display accepts no pictures of 8 bits a channel from this device: choose another with --device");
    return *found;
}

}  // namespace

Swapchain::Swapchain(const Context& context) : context_(&context), format_(find_format(context)) {}

void Swapchain::recreate(VkExtent2D window_size) {
    VkSurfaceCapabilitiesKHR surface{};
    check(vkGetPhysicalDeviceSurfaceCapabilitiesKHR(context_->physical_device(), context_->surface(), &surface),
          "vkGetPhysicalDeviceSurfaceCapabilitiesKHR");
    if (!(surface.supportedUsageFlags & VK_IMAGE_USAGE_TRANSFER_DST_BIT))
        throw tools::CommandError("this device cannot copy pictures to the display: choose another with --device");
    asked_ = window_size;
    extent_ = surface.currentExtent.width != UINT32_MAX
                  ? surface.currentExtent
                  : VkExtent2D{
                        std::clamp(window_size.width, surface.minImageExtent.width, surface.maxImageExtent.width),
                        std::clamp(window_size.height, surface.minImageExtent.height, surface.maxImageExtent.height)};
    const uint32_t wanted = surface.minImageCount + 1;
    const VkSwapchainCreateInfoKHR create{
        .sType = VK_STRUCTURE_TYPE_SWAPCHAIN_CREATE_INFO_KHR,
        .surface = context_->surface(),
        .minImageCount = surface.maxImageCount ? std::min(wanted, surface.maxImageCount) : wanted,
        .imageFormat = format_.format,
        .imageColorSpace = format_.colorSpace,
        .imageExtent = extent_,
        .imageArrayLayers = 1,
        .imageUsage = VK_IMAGE_USAGE_TRANSFER_DST_BIT,
        .imageSharingMode = VK_SHARING_MODE_EXCLUSIVE,
        .preTransform = surface.currentTransform,
        .compositeAlpha = VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR,
        // Every device has this mode, and it waits for the display
        .presentMode = VK_PRESENT_MODE_FIFO_KHR,
        .clipped = VK_TRUE,
        .oldSwapchain = swapchain_.get()};
    swapchain_ = {context_->device(), vkCreateSwapchainKHR, create, "vkCreateSwapchainKHR"};

    images_ = list_of<VkImage>("vkGetSwapchainImagesKHR", vkGetSwapchainImagesKHR, context_->device(),
                               swapchain_.get());
    const VkSemaphoreCreateInfo semaphore{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO};
    acquired_ = {context_->device(), vkCreateSemaphore, semaphore, "vkCreateSemaphore"};
    written_.clear();
    for (size_t i = 0; i < images_.size(); ++i)
        written_.emplace_back(context_->device(), vkCreateSemaphore, semaphore, "vkCreateSemaphore");
    stale_ = false;
}

std::optional<uint32_t> Swapchain::acquire() {
    uint32_t index = 0;
    const VkResult result = vkAcquireNextImageKHR(context_->device(), swapchain_.get(), UINT64_MAX, acquired_.get(),
                                                  VK_NULL_HANDLE, &index);
    stale_ |= result == VK_ERROR_OUT_OF_DATE_KHR || result == VK_SUBOPTIMAL_KHR;
    if (result == VK_ERROR_OUT_OF_DATE_KHR) return std::nullopt;
    if (result != VK_SUBOPTIMAL_KHR) check(result, "vkAcquireNextImageKHR");
    return index;
}

void Swapchain::present(uint32_t index) {
    const VkSwapchainKHR swapchain = swapchain_.get();
    const VkSemaphore written_semaphore = written(index);
    const VkPresentInfoKHR present_info{.sType = VK_STRUCTURE_TYPE_PRESENT_INFO_KHR,
                                        .waitSemaphoreCount = 1,
                                        .pWaitSemaphores = &written_semaphore,
                                        .swapchainCount = 1,
                                        .pSwapchains = &swapchain,
                                        .pImageIndices = &index};
    const VkResult result = vkQueuePresentKHR(context_->queue(), &present_info);
    if (result == VK_ERROR_OUT_OF_DATE_KHR || result == VK_SUBOPTIMAL_KHR)
        stale_ = true;
    else
        check(result, "vkQueuePresentKHR");
}

}  // namespace throng::view
