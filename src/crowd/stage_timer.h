// GPU times of the stages of updates: a timestamp at the beginning of each and after each stage. Of a few updates in turn, so that those that have finished can be read while
// others are under way; nothing waits.
#pragma once

#include "gpu/gpu.h"

#include <throng/crowd.h>

#include <array>
#include <optional>
#include <vector>

namespace throng {

class StageTimer {
public:
    StageTimer(std::shared_ptr<Gpu> gpu, uint32_t most_stages);
    ~StageTimer();
    StageTimer(const StageTimer&) = delete;
    StageTimer& operator=(const StageTimer&) = delete;

    // begin() once an update, then end_stage() after each stage, at most most_stages times; a stage may come several times. An update is not timed while as many as there are slots are under way.
    void begin(VkCommandBuffer commands);
    void end_stage(VkCommandBuffer commands, double StageTimes::*stage);
    // What has come since the last stage is none of the update's.
    void leave_out(VkCommandBuffer commands) { end_stage(commands, nullptr); }

    // Of the newest update that has finished. Throws kInvalidArgument where there is none.
    StageTimes read() const;
    // The same, but none where it has been taken before.
    std::optional<StageTimes> take_newest();

private:
    struct Slot {
        VkQueryPool pool = VK_NULL_HANDLE;
        VkEvent reset = VK_NULL_HANDLE;  // set when the pool holds nothing of the slot's last update any more
        uint64_t update = 0;             // counted from 1; 0: none
        std::vector<double StageTimes::*> stages;  // in order
    };
    void write(VkCommandBuffer commands, uint32_t query);
    std::optional<StageTimes> read(const Slot& slot) const;
    // Null where none has finished.
    const Slot* newest(StageTimes& times) const;

    std::shared_ptr<Gpu> gpu_;
    uint32_t query_count_ = 0;
    std::array<Slot, 4> slots_;
    Slot* current_ = nullptr;  // null: the update is not timed
    uint64_t update_count_ = 0, taken_ = 0;
};

}  // namespace throng
