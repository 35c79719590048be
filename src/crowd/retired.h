// What a crowd no longer has, but updates under way may still use.
#pragma once

#include "crowd/stage.h"
#include "gpu/event.h"

namespace throng {

class Retired {
public:
    struct Things {
        std::vector<std::unique_ptr<Stage>> stages{};
        std::vector<Batch> batches{};
        std::optional<Group> group{};
        std::unique_ptr<StageTimer> timer{};
    };
    // Things may go once `update_count` later updates have run, after which nothing reads the outputs of earlier ones,
    // and as many more have been recorded. The event alone would do, but validation layers do not follow events. They
    // know that commands have run by the fences of the application, which has waited for them by then.
    Retired(EventPool& events, uint32_t update_count)
        : have_run_(events.take()), left_(update_count), more_(update_count) {}
    void keep(Things things) {
        things_ = std::move(things);
        for (const auto& stage : things_.stages) stage->retire();
    }

    // At the end of each update.
    void record(VkCommandBuffer commands) {
        was_left_ = left_;
        if (left_ > 0) {
            if (--left_ == 0) have_run_.record_set(commands);
        } else if (more_ > 0 && have_run_.is_set()) {
            --more_;
        }
    }
    // The last update will never be submitted.
    void discard() { left_ = was_left_; }
    // Frees one of the things if they may go: all at once would take longer than recording an update.
    void free_one() {
        if (more_ > 0) return;
        if (!things_.batches.empty())
            things_.batches.pop_back();
        else if (!things_.stages.empty())
            things_.stages.pop_back();
        else
            things_ = {};
    }
    bool is_empty() const {
        return things_.stages.empty() && things_.batches.empty() && !things_.group && !things_.timer;
    }
    DeviceEvent take_event() { return std::move(have_run_); }  // once is_empty()
    uint64_t size_bytes() const {
        uint64_t sum = 0;
        for (const auto& stage : things_.stages) sum += stage->size_bytes();
        for (const Batch& batch : things_.batches) sum += batch.size_bytes();
        return sum + (things_.group ? things_.group->size_bytes() : 0);
    }

private:
    Things things_;
    DeviceEvent have_run_;
    uint32_t left_, was_left_ = 0, more_;
};

}  // namespace throng
