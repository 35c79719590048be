// The images that the display shows in turn.
#pragma once

#include "tools/view/context.h"

#include <optional>
#include <vector>

namespace throng::view {

class Swapchain {
public:
    // Throws a CommandError if the display takes no pictures of 8 bits a channel.
    explicit Swapchain(const Context& context);

    // Makes it anew, in the window's size if the surface does not give one. The device must be idle.
    void recreate(VkExtent2D window_size);
    // Whether the window has changed so that recreate() is due.
    bool is_stale(VkExtent2D window_size) const {
        return stale_ || window_size.width != asked_.width || window_size.height != asked_.height;
    }
    VkExtent2D extent() const { return extent_; }
    // VK_FORMAT_R8G8B8A8_UNORM or B8G8R8A8, whose bytes are sRGB.
    VkFormat format() const { return format_.format; }

    // The image to be written next, once acquired() is signalled; none if the swapchain is stale. Only one image can be
    // acquired at a time.
    std::optional<uint32_t> acquire();
    VkImage image(uint32_t index) const { return images_[index]; }
    VkSemaphore acquired() const { return acquired_.get(); }
    // What present() waits for.
    VkSemaphore written(uint32_t index) const { return written_[index].get(); }
    void present(uint32_t index);

private:
    const Context* context_;
    VkSurfaceFormatKHR format_;
    VkExtent2D asked_{}, extent_{};
    OwnedSwapchain swapchain_;
    std::vector<VkImage> images_;
    OwnedSemaphore acquired_;
    std::vector<OwnedSemaphore> written_;
    bool stale_ = true;
};

}  // namespace throng::view
