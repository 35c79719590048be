// GPU times of the stages of one update: a timestamp after each stage of each wave.
#pragma once

#include "gpu/gpu.h"

#include <throng/crowd.h>

namespace throng {

class StageTimer {
public:
    StageTimer(std::shared_ptr<Gpu> gpu, uint32_t wave_count);
    ~StageTimer();
    StageTimer(const StageTimer&) = delete;
    StageTimer& operator=(const StageTimer&) = delete;

    // begin() once an update, begin_wave() before each wave's first stage, end_stage() after each of its five stages.
    void begin(VkCommandBuffer commands);
    void begin_wave(VkCommandBuffer commands) { write(commands); }
    void end_stage(VkCommandBuffer commands) { write(commands); }

    // Throws kInvalidArgument where no update has finished.
    StageTimes read() const;

private:
    void write(VkCommandBuffer commands);

    std::shared_ptr<Gpu> gpu_;
    VkQueryPool pool_ = VK_NULL_HANDLE;
    uint32_t query_count_ = 0, next_ = 0;
};

}  // namespace throng
