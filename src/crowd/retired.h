// What a crowd does not have any more, and updates that are under way may still use.
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
        Buffer buffer{};
    };
    // They may go when so many later updates have run, after which nobody reads the outputs of earlier ones.
    Retired(const std::shared_ptr<Gpu>& gpu, Things things, uint32_t update_count)
        : things_(std::move(things)), have_run_(gpu), left_(update_count) {}

    // At the end of each update.
    void record(VkCommandBuffer commands) {
        was_left_ = left_;
        if (left_ == 0) return;
        if (--left_ == 0) have_run_.record_set(commands);
    }
    // The last update will never be submitted.
    void discard() { left_ = was_left_; }
    bool may_go() const { return left_ == 0 && have_run_.is_set(); }
    uint64_t size_bytes() const {
        uint64_t sum = 0;
        for (const auto& stage : things_.stages) sum += stage->size_bytes();
        for (const Batch& batch : things_.batches) sum += batch.size_bytes();
        return sum + (things_.group ? things_.group->size_bytes() : 0) + things_.buffer.size_bytes();
    }

private:
    Things things_;
    DeviceEvent have_run_;
    uint32_t left_, was_left_ = 0;
};

}  // namespace throng
