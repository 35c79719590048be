#include "crowd/followed_placements.h"

#include "gpu/barrier.h"

#include <algorithm>

namespace throng {

FollowedPlacements::FollowedPlacements(std::shared_ptr<Gpu> gpu, const std::vector<Batch>& batches,
                                       std::vector<FollowedBatch> followed)
    : gpu_(std::move(gpu)), batches_(batches), followed_(std::move(followed)) {
    VkDeviceSize size_bytes = 0;
    for (const FollowedBatch& of : followed_) size_bytes += placement_bytes(of) + birth_bytes(of);
    for (Slot& slot : slots_) {
        slot.copy = Buffer(gpu_, "placements that are followed", size_bytes, VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                           MemoryKind::kReadback);
        slot.done = DeviceEvent(gpu_);
    }
}

void FollowedPlacements::begin(uint64_t number) {
    Slot& slot = slots_[number % slots_.size()];
    next_ = is_free(slots_, slot, &Slot::number) ? &slot : nullptr;
    if (!next_) return;
    if (newest_ == next_) newest_ = nullptr;
    next_->done.reset();
    next_->number = number;
}

void FollowedPlacements::end(VkCommandBuffer commands) {
    if (!next_) return;
    memory_barrier(*gpu_, commands, kShaderWrite | kTransferWrite, kTransferRead | kTransferWrite);
    VkDeviceSize at = 0;
    const auto copy = [&](const Buffer& from, VkDeviceSize size_bytes) {
        if (size_bytes > 0)
            record_copy(*gpu_, commands, BufferRange(from, 0, size_bytes), BufferRange(next_->copy, at, size_bytes));
        at += size_bytes;
    };
    for (const FollowedBatch& of : followed_) {
        copy(batches_[of.batch][io::kPlacementsBuffer], placement_bytes(of));
        copy(batches_[of.batch][io::kBirthsBuffer], birth_bytes(of));
    }
    next_->done.record_set(commands);
}

void FollowedPlacements::discard() {
    if (next_) next_->number = 0;
    next_ = nullptr;
}

uint64_t FollowedPlacements::take_newest() {
    const Slot* newest = nullptr;
    for (const Slot& slot : slots_)
        if (is_there(slot) && slot.number > taken_ && (!newest || slot.number > newest->number)) newest = &slot;
    if (!newest) return 0;
    newest_ = newest;
    return taken_ = newest->number;
}

uint64_t FollowedPlacements::size_bytes() const {
    uint64_t sum = 0;
    for (const Slot& slot : slots_) sum += slot.copy.size_bytes();
    return sum;
}

}  // namespace throng
