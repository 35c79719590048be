// What the window shows: the crowd's picture with the panels over it, kept on the device, so that it can be copied to
// the display and to a file.
#pragma once

#include "tools/view/context.h"

#include <throng/draw.h>

namespace throng::view {

class Canvas {
public:
    // `format` is the display's, so that pictures are copied as they are. It is UNORM, because Dear ImGui's colours are
    // sRGB bytes and are blended as such.
    Canvas(const Context& context, VkFormat format);

    // The device must be idle.
    void resize(VkExtent2D extent);
    // Panels are drawn in it, over what is there.
    VkRenderPass render_pass() const { return render_pass_.get(); }

    // Call these in this order. `picture` is as large as the canvas, its bytes have the same order, and it is in
    // VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL.
    void record_picture(VkCommandBuffer commands, VkImage picture) const;
    void record_panels(VkCommandBuffer commands) const;
    // `shown` is an image of the swapchain, of the same size and format; afterwards it is ready to be presented.
    void record_copy(VkCommandBuffer commands, VkImage shown) const;
    void record_read_back(VkCommandBuffer commands) const;

    // What record_read_back() has copied, once its commands have run.
    Picture read() const;

private:
    VkExtent3D size() const { return {extent_.width, extent_.height, 1}; }

    const Context* context_;
    VkFormat format_;
    OwnedRenderPass render_pass_;
    VkExtent2D extent_{};
    OwnedMemory memory_;
    OwnedImage image_;
    OwnedImageView view_;
    OwnedFramebuffer framebuffer_;
    HostBuffer read_back_;
};

}  // namespace throng::view
