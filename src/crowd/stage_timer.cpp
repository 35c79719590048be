#include "crowd/stage_timer.h"

#include "base/failure.h"

#include <stdexcept>
#include <string>

namespace throng {

StageTimer::StageTimer(std::shared_ptr<Gpu> gpu, uint32_t max_stages) : stamps_(std::move(gpu), max_stages + 1) {}

void StageTimer::begin(VkCommandBuffer commands) {
    stamps_.begin(commands);
    stamps_.write(commands);
    stages_of(stamps_.frame_number()).clear();
}

void StageTimer::end_stage(VkCommandBuffer commands, std::string_view name) {
    const size_t stage = index_of_stage(name);
    if (stage >= stage_names().size()) throw std::logic_error("stage_names() has no " + std::string(name));
    end(commands, stage);
}

void StageTimer::end(VkCommandBuffer commands, size_t stage) {
    stages_of(stamps_.frame_number()).push_back(stage);
    stamps_.write(commands);
}

StageTimes StageTimer::times_of(const Timestamps::Frame& frame) const {
    const std::vector<size_t>& stages = stages_[frame.number % Timestamps::kFrames];
    StageTimes times;
    for (size_t i = 0; i < stages.size(); ++i)
        if (stages[i] < times.ms.size()) times.ms[stages[i]] += frame.ms[i + 1] - frame.ms[i];
    return times;
}

StageTimes StageTimer::read() const {
    const std::optional<Timestamps::Frame> frame = stamps_.newest();
    if (!frame) throw Failure(ErrorCode::kInvalidArgument, "stage times", "no update has finished");
    return times_of(*frame);
}

std::optional<StageTimes> StageTimer::take_newest() {
    const std::optional<Timestamps::Frame> frame = stamps_.newest();
    if (!frame || frame->number == taken_) return {};
    taken_ = frame->number;
    return times_of(*frame);
}

}  // namespace throng
