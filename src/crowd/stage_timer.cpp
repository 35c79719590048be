#include "crowd/stage_timer.h"

#include "base/failure.h"

#include <cassert>

namespace throng {

StageTimer::StageTimer(std::shared_ptr<Gpu> gpu, uint32_t most_stages) : gpu_(std::move(gpu)), query_count_(most_stages + 1) {
    VkQueryPoolCreateInfo create{VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO};
    create.queryType = VK_QUERY_TYPE_TIMESTAMP;
    create.queryCount = query_count_;
    check(gpu_->vk.vkCreateQueryPool(gpu_->device, &create, nullptr, &pool_), "vkCreateQueryPool");
}

StageTimer::~StageTimer() {
    gpu_->vk.vkDestroyQueryPool(gpu_->device, pool_, nullptr);
}

void StageTimer::begin(VkCommandBuffer commands) {
    stages_.clear();
    begun_ = true;
    gpu_->vk.vkCmdResetQueryPool(commands, pool_, 0, query_count_);
    write(commands, 0);
}

void StageTimer::end_stage(VkCommandBuffer commands, double StageTimes::*stage) {
    stages_.push_back(stage);
    write(commands, static_cast<uint32_t>(stages_.size()));
}

void StageTimer::write(VkCommandBuffer commands, uint32_t query) {
    assert(query < query_count_);
    gpu_->vk.vkCmdWriteTimestamp2(commands, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, pool_, query);
}

StageTimes StageTimer::read() const {
    if (!begun_) throw Failure(ErrorCode::kInvalidArgument, "stage times", "no update has been recorded");
    if (const std::optional<StageTimes> times = read_if_finished()) return *times;
    throw Failure(ErrorCode::kInvalidArgument, "stage times", "the last update has not finished");
}

std::optional<StageTimes> StageTimer::read_if_finished() const {
    if (!begun_) return {};
    std::vector<uint64_t> ticks(stages_.size() + 1);
    const VkResult result = gpu_->vk.vkGetQueryPoolResults(gpu_->device, pool_, 0, static_cast<uint32_t>(ticks.size()), ticks.size() * sizeof(uint64_t), ticks.data(),
                                                           sizeof(uint64_t), VK_QUERY_RESULT_64_BIT);
    if (result == VK_NOT_READY) return {};
    check(result, "vkGetQueryPoolResults");

    const uint64_t mask = gpu_->timestamp_valid_bits >= 64 ? ~uint64_t{0} : (uint64_t{1} << gpu_->timestamp_valid_bits) - 1;
    StageTimes times;
    for (size_t i = 0; i < stages_.size(); ++i) {
        if (!stages_[i]) continue;
        const uint64_t elapsed = (ticks[i + 1] - ticks[i]) & mask;
        times.*stages_[i] += static_cast<double>(elapsed) * double{gpu_->properties.limits.timestampPeriod} * 1e-6;
    }
    return times;
}

}  // namespace throng
