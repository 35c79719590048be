// A 2D image with memory and view of its own.
#pragma once

#include "gpu/owned.h"
#include "gpu/barrier.h"

#include <string_view>

namespace throng {

struct ImageSettings {
    std::string_view what;  // for messages
    uint32_t width = 1, height = 1;
    uint32_t mip_count = 1;
    VkFormat format = VK_FORMAT_R8G8B8A8_SRGB;
    VkImageUsageFlags usage = 0;
    VkSampleCountFlagBits samples = VK_SAMPLE_COUNT_1_BIT;
};

class Image {
public:
    Image() = default;
    // Throws kLimit where the image exceeds the device's dimensions or its largest allocation.
    Image(const std::shared_ptr<Gpu>& gpu, const ImageSettings& settings);

    VkImage handle() const { return image_.get(); }
    VkImageView view() const { return view_.get(); }

private:
    OwnedMemory memory_;  // outlives the image bound to it
    OwnedImage image_;
    OwnedImageView view_;
};

struct Transition {
    VkImage image = VK_NULL_HANDLE;
    VkImageAspectFlags aspect = VK_IMAGE_ASPECT_COLOR_BIT;
    uint32_t first_mip = 0, mip_count = VK_REMAINING_MIP_LEVELS;
    VkImageLayout from = VK_IMAGE_LAYOUT_UNDEFINED, to = VK_IMAGE_LAYOUT_UNDEFINED;
    Access before{VK_PIPELINE_STAGE_2_NONE, VK_ACCESS_2_NONE}, after{VK_PIPELINE_STAGE_2_NONE, VK_ACCESS_2_NONE};
};
void transition(const Gpu& gpu, VkCommandBuffer commands, const Transition& transition);

}  // namespace throng
