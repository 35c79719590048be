// A 2D image with its own memory and view.
#pragma once

#include "gpu/barrier.h"
#include "gpu/owned.h"

#include <string_view>

namespace throng {

struct ImageSettings {
    std::string_view what;  // for messages
    VkExtent2D extent{1, 1};
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
    VkImageView view() const { return view_.get(); }  // null where the image is only copied from and to

private:
    OwnedMemory memory_;  // outlives the image bound to it
    OwnedImage image_;
    OwnedImageView view_;
};

// How an image is used between two transitions.
struct ImageUse {
    VkImageLayout layout;
    Access access;
};
// The image's content is lost.
constexpr ImageUse discarded_after(const Access& access) { return {VK_IMAGE_LAYOUT_UNDEFINED, access}; }
inline constexpr ImageUse kColorTarget{VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL, kColorWrite},
    kDepthTarget{VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL, kDepthAccess},
    kTexture{VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL, kFragmentRead},
    kDepthTexture{VK_IMAGE_LAYOUT_DEPTH_READ_ONLY_OPTIMAL, kFragmentRead},
    kCopySource{VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, kTransferRead},
    kCopyTarget{VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, kTransferWrite};

// The aspect is depth if either use is a depth use, else colour.
void transition(const Gpu& gpu, VkCommandBuffer commands, VkImage image, const ImageUse& from, const ImageUse& to,
                uint32_t first_mip = 0, uint32_t mip_count = VK_REMAINING_MIP_LEVELS);

// An attachment of a render pass that draws to the image.
VkRenderingAttachmentInfo attachment(const Image& image, const ImageUse& use, VkAttachmentLoadOp load,
                                     VkAttachmentStoreOp store);
// Renders to the whole extent, and sets viewport and scissor to it. One of the two attachments may be null.
void begin_rendering(const Gpu& gpu, VkCommandBuffer commands, const VkExtent2D& extent,
                     const VkRenderingAttachmentInfo* color, const VkRenderingAttachmentInfo* depth);

OwnedSampler make_nearest_sampler(const std::shared_ptr<Gpu>& gpu);

}  // namespace throng
