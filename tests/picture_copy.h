// Reads the pictures of recorded frames.
#pragma once

#include "gpu/barrier.h"
#include "gpu/buffer.h"
#include "tests/kernel_runner.h"

#include <throng/draw.h>

namespace throng::test {

// What a frame's commands leave in Renderer::picture(), copied by the same commands.
class PictureCopy {
public:
    PictureCopy(uint32_t width, uint32_t height)
        : width_(width),
          height_(height),
          buffer_(test_gpu(), "copy", uint64_t{4} * width * height, 0, MemoryKind::kReadback) {}
    void record(VkCommandBuffer commands, const Renderer& renderer) const {
        const VkBufferImageCopy region{.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                                       .imageExtent = {width_, height_, 1}};
        test_gpu()->vk.vkCmdCopyImageToBuffer(commands, renderer.picture(), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                                              buffer_.handle(), 1, &region);
        memory_barrier(*test_gpu(), commands, kTransferWrite, kHostRead);
    }
    Picture picture() const {
        const auto* const bytes = reinterpret_cast<const uint8_t*>(buffer_.mapped());
        return {width_, height_, {bytes, bytes + size_t{4} * width_ * height_}};
    }

private:
    uint32_t width_, height_;
    Buffer buffer_;
};

}  // namespace throng::test
