#include "draw/rendering.h"

namespace throng {
namespace {

VkRenderingAttachmentInfo attachment(const Image& image, VkImageLayout layout, VkAttachmentLoadOp load,
                                     VkAttachmentStoreOp store) {
    VkRenderingAttachmentInfo info{VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO};
    info.imageView = image.view();
    info.imageLayout = layout;
    info.loadOp = load;
    info.storeOp = store;
    return info;
}

}  // namespace

VkRenderingAttachmentInfo color_attachment(const Image& image, VkAttachmentStoreOp store) {
    return attachment(image, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL, VK_ATTACHMENT_LOAD_OP_DONT_CARE, store);
}

VkRenderingAttachmentInfo depth_attachment(const Image& image, VkAttachmentStoreOp store) {
    VkRenderingAttachmentInfo depth = attachment(image, VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL,
                                                 VK_ATTACHMENT_LOAD_OP_CLEAR, store);
    depth.clearValue.depthStencil = {0, 0};
    return depth;
}

void begin_rendering(const Gpu& gpu, VkCommandBuffer commands, const VkExtent2D& extent,
                     const VkRenderingAttachmentInfo* color, const VkRenderingAttachmentInfo* depth) {
    VkRenderingInfo rendering{VK_STRUCTURE_TYPE_RENDERING_INFO};
    rendering.renderArea = {{0, 0}, extent};
    rendering.layerCount = 1;
    rendering.colorAttachmentCount = color ? 1 : 0;
    rendering.pColorAttachments = color;
    rendering.pDepthAttachment = depth;
    gpu.vk.vkCmdBeginRendering(commands, &rendering);
    const VkViewport viewport{0, 0, static_cast<float>(extent.width), static_cast<float>(extent.height), 0, 1};
    gpu.vk.vkCmdSetViewport(commands, 0, 1, &viewport);
    gpu.vk.vkCmdSetScissor(commands, 0, 1, &rendering.renderArea);
}

}  // namespace throng
