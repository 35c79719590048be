#include "crowd/depth_pyramid.h"

#include "gpu/barrier.h"

#include <algorithm>

namespace throng {
namespace {

uint64_t texel_count(uint32_t width, uint32_t height) {
    uint64_t count = 0;
    do {
        width = (width + 1) / 2;
        height = (height + 1) / 2;
        count += uint64_t{width} * height;
    } while (width > 1 || height > 1);
    return count;
}

}  // namespace

DepthPyramid::DepthPyramid(std::shared_ptr<Gpu> gpu, const Kernel& kernel, uint32_t width, uint32_t height)
    : gpu_(std::move(gpu)),
      picture_(gpu_, "depths of a picture", uint64_t{width} * height * sizeof(float),
               VK_BUFFER_USAGE_STORAGE_BUFFER_BIT),
      levels_(gpu_, "depth pyramid", texel_count(width, height) * sizeof(float), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT),
      from_picture_(kernel.bind({{io::kDepthsBuffer, picture_}, {io::kCoarserDepthsBuffer, levels_}})),
      from_levels_(kernel.bind({{io::kDepthsBuffer, levels_}, {io::kCoarserDepthsBuffer, levels_}})) {}

bool DepthPyramid::has_room_for(const DepthImage& depths) const {
    return uint64_t{depths.width} * depths.height * sizeof(float) <= picture_.size_bytes() &&
           texel_count(depths.width, depths.height) * sizeof(float) <= levels_.size_bytes();
}

void DepthPyramid::record(VkCommandBuffer commands, const Kernel& kernel, const DepthImage& depths) const {
    // Readers of the last pyramid must have finished.
    memory_barrier(*gpu_, commands, kShaderRead | kShaderWrite, kTransferWrite);
    VkBufferImageCopy copy{};
    copy.imageSubresource = {depths.aspect, 0, 0, 1};
    copy.imageExtent = {depths.width, depths.height, 1};
    gpu_->vk.vkCmdCopyImageToBuffer(commands, depths.image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, picture_.handle(), 1,
                                    &copy);
    memory_barrier(*gpu_, commands, kTransferWrite, kShaderRead);
    io::PyramidPush push{.width = depths.width,
                         .height = depths.height,
                         .first_read = 0,
                         .first_written = 0,
                         .sign = depths.reversed ? 1.0f : -1.0f};
    for (bool is_first = true;; is_first = false) {
        const uint32_t width = (push.width + 1) / 2, height = (push.height + 1) / 2;
        const uint32_t workgroups = std::min((width * height - 1) / io::kCullWorkgroupSize + 1,
                                             gpu_->properties.limits.maxComputeWorkGroupCount[0]);
        kernel.dispatch_workgroups(commands, is_first ? from_picture_ : from_levels_, push, workgroups);
        memory_barrier(*gpu_, commands, kShaderWrite, kShaderRead);
        if (width == 1 && height == 1) return;
        push = {.width = width,
                .height = height,
                .first_read = push.first_written,
                .first_written = push.first_written + width * height,
                .sign = 1};
    }
}

}  // namespace throng
