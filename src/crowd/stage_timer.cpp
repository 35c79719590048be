#include "crowd/stage_timer.h"

#include "base/failure.h"

#include <cassert>

namespace throng {

StageTimer::StageTimer(std::shared_ptr<Gpu> gpu, uint32_t most_stages) : gpu_(std::move(gpu)), query_count_(most_stages + 1) {
    VkQueryPoolCreateInfo create{VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO};
    create.queryType = VK_QUERY_TYPE_TIMESTAMP;
    create.queryCount = query_count_;
    const VkEventCreateInfo event{VK_STRUCTURE_TYPE_EVENT_CREATE_INFO};
    for (Slot& slot : slots_) {
        check(gpu_->vk.vkCreateQueryPool(gpu_->device, &create, nullptr, &slot.pool), "vkCreateQueryPool");
        check(gpu_->vk.vkCreateEvent(gpu_->device, &event, nullptr, &slot.reset), "vkCreateEvent");
    }
}

StageTimer::~StageTimer() {
    for (const Slot& slot : slots_) {
        gpu_->vk.vkDestroyQueryPool(gpu_->device, slot.pool, nullptr);
        gpu_->vk.vkDestroyEvent(gpu_->device, slot.reset, nullptr);
    }
}

void StageTimer::begin(VkCommandBuffer commands) {
    Slot& slot = slots_[update_count_ % slots_.size()];
    current_ = slot.update == 0 || read(slot) ? &slot : nullptr;
    if (!current_) return;
    slot.update = ++update_count_;
    slot.stages.clear();
    check(gpu_->vk.vkResetEvent(gpu_->device, slot.reset), "vkResetEvent");
    gpu_->vk.vkCmdResetQueryPool(commands, slot.pool, 0, query_count_);
    gpu_->vk.vkCmdSetEvent(commands, slot.reset, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT);
    write(commands, 0);
}

void StageTimer::end_stage(VkCommandBuffer commands, double StageTimes::*stage) {
    if (!current_) return;
    current_->stages.push_back(stage);
    write(commands, static_cast<uint32_t>(current_->stages.size()));
}

void StageTimer::write(VkCommandBuffer commands, uint32_t query) {
    assert(query < query_count_);
    gpu_->vk.vkCmdWriteTimestamp2(commands, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, current_->pool, query);
}

StageTimes StageTimer::read() const {
    StageTimes times;
    if (!newest(times)) throw Failure(ErrorCode::kInvalidArgument, "stage times", "no update has finished");
    return times;
}

std::optional<StageTimes> StageTimer::take_newest() {
    StageTimes times;
    const Slot* slot = newest(times);
    if (!slot || slot->update == taken_) return {};
    taken_ = slot->update;
    return times;
}

const StageTimer::Slot* StageTimer::newest(StageTimes& times) const {
    const Slot* found = nullptr;
    for (const Slot& slot : slots_) {
        if (slot.update == 0 || (found && slot.update < found->update)) continue;
        const std::optional<StageTimes> of_slot = read(slot);
        if (!of_slot) continue;
        times = *of_slot;
        found = &slot;
    }
    return found;
}

std::optional<StageTimes> StageTimer::read(const Slot& slot) const {
    if (gpu_->vk.vkGetEventStatus(gpu_->device, slot.reset) != VK_EVENT_SET) return {};
    std::vector<uint64_t> ticks(slot.stages.size() + 1);
    const VkResult result = gpu_->vk.vkGetQueryPoolResults(gpu_->device, slot.pool, 0, static_cast<uint32_t>(ticks.size()), ticks.size() * sizeof(uint64_t), ticks.data(),
                                                           sizeof(uint64_t), VK_QUERY_RESULT_64_BIT);
    if (result == VK_NOT_READY) return {};
    check(result, "vkGetQueryPoolResults");

    const uint64_t mask = gpu_->timestamp_valid_bits >= 64 ? ~uint64_t{0} : (uint64_t{1} << gpu_->timestamp_valid_bits) - 1;
    StageTimes times;
    for (size_t i = 0; i < slot.stages.size(); ++i) {
        if (!slot.stages[i]) continue;
        const uint64_t elapsed = (ticks[i + 1] - ticks[i]) & mask;
        times.*slot.stages[i] += static_cast<double>(elapsed) * double{gpu_->properties.limits.timestampPeriod} * 1e-6;
    }
    return times;
}

}  // namespace throng
