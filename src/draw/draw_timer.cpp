#include "draw/draw_timer.h"

#include <array>

namespace throng {

DrawTimer::DrawTimer(std::shared_ptr<Gpu> gpu) : gpu_(std::move(gpu)) {
    if (!gpu_->has_timestamps()) return;
    VkQueryPoolCreateInfo create{VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO};
    create.queryType = VK_QUERY_TYPE_TIMESTAMP;
    create.queryCount = kStamps * kFrames;
    queries_ = OwnedQueries(gpu_, gpu_->vk.vkCreateQueryPool, create, "vkCreateQueryPool");
    gpu_->submit_and_wait([&](VkCommandBuffer commands) { gpu_->vk.vkCmdResetQueryPool(commands, queries_.get(), 0, create.queryCount); });
}

void DrawTimer::begin_occluders(VkCommandBuffer commands) {
    frame_ = (frame_ + 1) % kFrames;
    has_occluders_ = true;
    if (queries_.get()) gpu_->vk.vkCmdResetQueryPool(commands, queries_.get(), kStamps * frame_, kStamps);
    write(commands, 0);
}

void DrawTimer::begin(VkCommandBuffer commands) {
    if (!has_occluders_) {
        begin_occluders(commands);
        end_occluders(commands);
    }
    has_occluders_ = false;
    write(commands, 2);
}

void DrawTimer::write(VkCommandBuffer commands, uint32_t stamp) const {
    if (queries_.get()) gpu_->vk.vkCmdWriteTimestamp2(commands, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, queries_.get(), kStamps * frame_ + stamp);
}

double DrawTimer::read_ms() const {
    if (!queries_.get()) return 0;
    const uint64_t mask = gpu_->timestamp_valid_bits >= 64 ? ~uint64_t{0} : (uint64_t{1} << gpu_->timestamp_valid_bits) - 1;
    uint64_t latest = 0, elapsed = 0;
    for (uint32_t frame = 0; frame < kFrames; ++frame) {
        std::array<uint64_t, kStamps> ticks{};
        const VkResult result = gpu_->vk.vkGetQueryPoolResults(gpu_->device, queries_.get(), kStamps * frame, kStamps, sizeof ticks, ticks.data(), sizeof(uint64_t), VK_QUERY_RESULT_64_BIT);
        if (result == VK_NOT_READY) continue;
        check(result, "vkGetQueryPoolResults");
        // A frame that is recorded and has not begun still has the times of the one kFrames before.
        if (ticks[3] <= latest) continue;
        latest = ticks[3];
        elapsed = ((ticks[1] - ticks[0]) & mask) + ((ticks[3] - ticks[2]) & mask);
    }
    return static_cast<double>(elapsed) * double{gpu_->properties.limits.timestampPeriod} * 1e-6;
}

}  // namespace throng
