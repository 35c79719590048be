// GPU times of the stages of one update: a timestamp at its beginning and after each stage.
#pragma once

#include "gpu/gpu.h"

#include <throng/crowd.h>

#include <optional>
#include <vector>

namespace throng {

class StageTimer {
public:
    StageTimer(std::shared_ptr<Gpu> gpu, uint32_t most_stages);
    ~StageTimer();
    StageTimer(const StageTimer&) = delete;
    StageTimer& operator=(const StageTimer&) = delete;

    // begin() once an update, then end_stage() after each stage, at most most_stages times; a stage may come several times.
    void begin(VkCommandBuffer commands);
    void end_stage(VkCommandBuffer commands, double StageTimes::*stage);
    // What has come since the last stage is none of the update's.
    void leave_out(VkCommandBuffer commands) { end_stage(commands, nullptr); }

    // Throws kInvalidArgument where no update has finished.
    StageTimes read() const;
    // None where the last update has not finished, or there was none.
    std::optional<StageTimes> read_if_finished() const;

private:
    void write(VkCommandBuffer commands, uint32_t query);

    std::shared_ptr<Gpu> gpu_;
    VkQueryPool pool_ = VK_NULL_HANDLE;
    uint32_t query_count_ = 0;
    bool begun_ = false;
    std::vector<double StageTimes::*> stages_;  // of the last update, in order
};

}  // namespace throng
