#include "gpu/timestamps.h"

#include "gpu/barrier.h"

#include <atomic>
#include <cassert>
#include <chrono>

namespace throng {
namespace {

uint64_t nanoseconds_now() {
    return static_cast<uint64_t>(std::chrono::steady_clock::now().time_since_epoch() / std::chrono::nanoseconds(1));
}

}  // namespace

Timestamps::Timestamps(std::shared_ptr<Gpu> gpu, uint32_t stamps_per_frame)
    : gpu_(std::move(gpu)), stamps_per_frame_(stamps_per_frame) {
    if (!gpu_->has_timestamps()) return;
    const VkQueryPoolCreateInfo queries{.sType = VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO,
                                        .queryType = VK_QUERY_TYPE_TIMESTAMP,
                                        .queryCount = stamps_per_frame_};
    for (Slot& slot : slots_) {
        if (!gpu_->is_native())
            slot.queries = OwnedQueryPool(gpu_, gpu_->vk.vkCreateQueryPool, queries, "vkCreateQueryPool");
        const VkDeviceSize size_bytes = (1 + VkDeviceSize{stamps_per_frame_}) * sizeof(uint64_t);
        slot.copy = Buffer(gpu_, "timestamps", size_bytes, VK_BUFFER_USAGE_TRANSFER_DST_BIT, MemoryKind::kReadback);
        std::memset(slot.copy.mapped(), 0, sizeof(uint64_t));  // no publication has the number 0
    }
}

void Timestamps::begin(VkCommandBuffer commands) {
    if (!gpu_->has_timestamps()) return;
    Slot& slot = slots_[++frame_count_ % kFrames];
    slot.frame_number = frame_count_;
    slot.publication = 0;
    slot.stamp_count = slot.published_count = 0;
    if (commands) gpu_->vk.vkCmdResetQueryPool(commands, slot.queries.get(), 0, stamps_per_frame_);
}

void Timestamps::write(VkCommandBuffer commands) {
    if (!gpu_->has_timestamps()) return;
    Slot& slot = slots_[frame_count_ % kFrames];
    assert(slot.stamp_count < stamps_per_frame_);
    const uint32_t index = slot.stamp_count++;
    if (!commands)
        reinterpret_cast<uint64_t*>(slot.copy.mapped())[1 + index] = nanoseconds_now();
    else
        gpu_->vk.vkCmdWriteTimestamp2(commands, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, slot.queries.get(), index);
}

// The number of the publication is written last: once it is there, the stamps are complete and none is of an earlier
// frame in the slot.
void Timestamps::publish(VkCommandBuffer commands) {
    if (!gpu_->has_timestamps()) return;
    Slot& slot = slots_[frame_count_ % kFrames];
    slot.publication = ++publication_count_;
    if (!commands) {
        std::memcpy(slot.copy.mapped(), &slot.publication, sizeof slot.publication);
        return;
    }
    memory_barrier(*gpu_, commands, kTransferWrite, kTransferWrite);
    gpu_->vk.vkCmdCopyQueryPoolResults(commands, slot.queries.get(), slot.published_count,
                                       slot.stamp_count - slot.published_count, slot.copy.handle(),
                                       (1 + VkDeviceSize{slot.published_count}) * sizeof(uint64_t), sizeof(uint64_t),
                                       VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WAIT_BIT);
    slot.published_count = slot.stamp_count;
    memory_barrier(*gpu_, commands, kTransferWrite, kTransferWrite);
    gpu_->vk.vkCmdUpdateBuffer(commands, slot.copy.handle(), 0, sizeof slot.publication, &slot.publication);
    memory_barrier(*gpu_, commands, kTransferWrite, kHostRead);
}

bool Timestamps::is_finished(const Slot& slot) const {
    if (slot.publication == 0) return false;
    uint64_t& publication = *reinterpret_cast<uint64_t*>(slot.copy.mapped());
    return std::atomic_ref(publication).load(std::memory_order_acquire) == slot.publication;
}

Timestamps::Frame Timestamps::read(const Slot& slot) const {
    std::vector<uint64_t> ticks(slot.stamp_count);
    std::memcpy(ticks.data(), slot.copy.mapped() + sizeof(uint64_t), ticks.size() * sizeof(uint64_t));
    const uint64_t mask = gpu_->timestamp_valid_bits >= 64 ? ~uint64_t{0}
                                                           : (uint64_t{1} << gpu_->timestamp_valid_bits) - 1;
    Frame frame{slot.frame_number, {}};
    for (const uint64_t tick : ticks)
        frame.ms.push_back(static_cast<double>((tick - ticks[0]) & mask) *
                           double{gpu_->properties.limits.timestampPeriod} * 1e-6);
    return frame;
}

std::optional<Timestamps::Frame> Timestamps::newest() const {
    const Slot* newest = nullptr;
    for (const Slot& slot : slots_)
        if (is_finished(slot) && (!newest || slot.frame_number > newest->frame_number)) newest = &slot;
    return newest ? std::optional(read(*newest)) : std::nullopt;
}

}  // namespace throng
