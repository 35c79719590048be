// GPU times of the stages of updates: a timestamp at the beginning of each and after each stage. Nothing waits.
#pragma once

#include "gpu/timestamps.h"

#include <throng/crowd.h>

namespace throng {

class StageTimer {
public:
    StageTimer(std::shared_ptr<Gpu> gpu, uint32_t max_stages);

    // begin() once an update, then end_stage() after each stage, at most max_stages times; a stage may come several
    // times. publish() after the last one, and again after the second half of an update.
    void begin(VkCommandBuffer commands);
    // `name`: one of stage_names().
    void end_stage(VkCommandBuffer commands, std::string_view name);
    // The time since the last stage, in which the application was drawing, counts for no stage.
    void leave_out(VkCommandBuffer commands) { end(commands, kStageLimit); }
    void publish(VkCommandBuffer commands) { stamps_.publish(commands); }

    // Times of the newest update that has finished. Throws kInvalidArgument where there is none.
    StageTimes read() const;
    // The same, but none if it has been taken before.
    std::optional<StageTimes> take_newest();

private:
    // `stage`: index into stage_names(); kStageLimit for none.
    void end(VkCommandBuffer commands, size_t stage);
    std::vector<size_t>& stages_of(uint64_t frame) { return stages_[frame % Timestamps::kFrames]; }
    StageTimes times_of(const Timestamps::Frame& frame) const;

    Timestamps stamps_;
    std::array<std::vector<size_t>, Timestamps::kFrames> stages_;  // of each update, in their order
    uint64_t taken_ = 0;
};

}  // namespace throng
