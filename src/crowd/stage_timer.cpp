#include "crowd/stage_timer.h"

#include "base/failure.h"

#include <array>

namespace throng {
namespace {

constexpr std::array kStages{&StageTimes::control, &StageTimes::sample, &StageTimes::blend, &StageTimes::scan, &StageTimes::bind};
constexpr uint32_t kQueriesPerWave = kStages.size() + 1;

}  // namespace

StageTimer::StageTimer(std::shared_ptr<Gpu> gpu, uint32_t wave_count) : gpu_(std::move(gpu)), query_count_(wave_count * kQueriesPerWave) {
    VkQueryPoolCreateInfo create{VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO};
    create.queryType = VK_QUERY_TYPE_TIMESTAMP;
    create.queryCount = query_count_;
    check(gpu_->vk.vkCreateQueryPool(gpu_->device, &create, nullptr, &pool_), "vkCreateQueryPool");
}

StageTimer::~StageTimer() {
    gpu_->vk.vkDestroyQueryPool(gpu_->device, pool_, nullptr);
}

void StageTimer::begin(VkCommandBuffer commands) {
    next_ = 0;
    gpu_->vk.vkCmdResetQueryPool(commands, pool_, 0, query_count_);
}

void StageTimer::write(VkCommandBuffer commands) {
    gpu_->vk.vkCmdWriteTimestamp2(commands, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, pool_, next_++);
}

StageTimes StageTimer::read() const {
    if (next_ == 0) throw Failure(ErrorCode::kInvalidArgument, "stage times", "no update has been recorded");
    std::vector<uint64_t> ticks(query_count_);
    const VkResult result = gpu_->vk.vkGetQueryPoolResults(gpu_->device, pool_, 0, query_count_, query_count_ * sizeof(uint64_t), ticks.data(),
                                                           sizeof(uint64_t), VK_QUERY_RESULT_64_BIT);
    if (result == VK_NOT_READY) throw Failure(ErrorCode::kInvalidArgument, "stage times", "the last update has not finished");
    check(result, "vkGetQueryPoolResults");

    const uint64_t mask = gpu_->timestamp_valid_bits >= 64 ? ~uint64_t{0} : (uint64_t{1} << gpu_->timestamp_valid_bits) - 1;
    StageTimes times;
    for (uint32_t wave = 0; wave < query_count_; wave += kQueriesPerWave)
        for (uint32_t stage = 0; stage < kStages.size(); ++stage) {
            const uint64_t elapsed = (ticks[wave + stage + 1] - ticks[wave + stage]) & mask;
            times.*kStages[stage] += static_cast<double>(elapsed) * double{gpu_->properties.limits.timestampPeriod} * 1e-6;
        }
    return times;
}

}  // namespace throng
