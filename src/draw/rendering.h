// Where a render pass draws to.
#pragma once

#include "draw/image.h"

namespace throng {

// Undefined at first: the pass writes all of it.
VkRenderingAttachmentInfo color_attachment(const Image& image, VkAttachmentStoreOp store);
// 0 at first: infinitely far from a camera, lowest towards the sun.
VkRenderingAttachmentInfo depth_attachment(const Image& image, VkAttachmentStoreOp store);

// Over all of the attachments, viewport and scissor set. One of the two may be null.
void begin_rendering(const Gpu& gpu, VkCommandBuffer commands, const VkExtent2D& extent,
                     const VkRenderingAttachmentInfo* color, const VkRenderingAttachmentInfo* depth);

}  // namespace throng
