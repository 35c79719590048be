#include "draw/staged_picture.h"

#include "draw/pipeline.h"

#include <algorithm>

namespace throng {

StagedPicture::StagedPicture(std::shared_ptr<Gpu> gpu, VkExtent2D extent, bool blue_first)
    : gpu_(std::move(gpu)),
      extent_(extent),
      image_(gpu_, {.what = "picture",
                    .extent = extent,
                    .format = color_format(blue_first),
                    .usage = VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT}) {}

uint8_t* StagedPicture::next() {
    const auto free = std::ranges::find_if(slots_,
                                           [&](const Slot& slot) { return is_free(slots_, slot, &Slot::number); });
    current_ = free != slots_.end()
                   ? &*free
                   : &slots_.emplace_back(
                         Slot{.pixels = Buffer(gpu_, "drawn picture", VkDeviceSize{4} * extent_.width * extent_.height,
                                               VK_BUFFER_USAGE_TRANSFER_SRC_BIT, MemoryKind::kUpload),
                              .done = DeviceEvent(gpu_)});
    if (std::exchange(current_->number, 0) != 0) current_->done.reset();
    return reinterpret_cast<uint8_t*>(current_->pixels.mapped());
}

void StagedPicture::record(VkCommandBuffer commands) {
    transition(*gpu_, commands, image(), discarded_after(kTransferRead), kCopyTarget);
    const VkBufferImageCopy copy{.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                                 .imageExtent = {extent_.width, extent_.height, 1}};
    gpu_->vk.vkCmdCopyBufferToImage(commands, current_->pixels.handle(), image(), kCopyTarget.layout, 1, &copy);
    transition(*gpu_, commands, image(), kCopyTarget, kCopySource);
    current_->done.record_set(commands);
    current_->number = ++record_count_;
}

void StagedPicture::record_copy(VkCommandBuffer commands, VkImage picture) const {
    transition(*gpu_, commands, image(), discarded_after(kTransferRead), kCopyTarget);
    const VkImageSubresourceLayers color{VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
    const VkImageCopy copy{
        .srcSubresource = color, .dstSubresource = color, .extent = {extent_.width, extent_.height, 1}};
    gpu_->vk.vkCmdCopyImage(commands, picture, kCopySource.layout, image(), kCopyTarget.layout, 1, &copy);
    transition(*gpu_, commands, image(), kCopyTarget, kCopySource);
}

}  // namespace throng
