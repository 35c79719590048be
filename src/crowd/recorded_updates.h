// Whether the commands that the last update was recorded into have run.
#pragma once

#include "gpu/event.h"

#include <algorithm>
#include <deque>
#include <utility>

namespace throng {

class RecordedUpdates {
public:
    explicit RecordedUpdates(EventPool& events) : events_(events) {}

    // At the end of an update.
    void record(VkCommandBuffer commands) {
        if (!commands) return;
        give_back_known();
        under_way_.push_back(events_.take());
        under_way_.back().record_set_behind_all(commands);
    }
    // The last update will never be submitted.
    void discard() {
        events_.give_back(std::move(under_way_.back()));
        under_way_.pop_back();
    }
    bool has_last_run() const { return under_way_.empty() || under_way_.back().is_set(); }

private:
    // Commands run in the order in which they were recorded: if some have run, those recorded earlier have run too, or
    // never will. If kMaximum are pending and none has run, the oldest is assumed never to run.
    void give_back_known() {
        constexpr size_t kMaximum = 64;
        size_t known = under_way_.size();
        while (known > 0 && !under_way_[known - 1].is_set()) --known;
        if (under_way_.size() == kMaximum) known = std::max<size_t>(known, 1);
        for (; known > 0; --known) {
            events_.give_back(std::move(under_way_.front()));
            under_way_.pop_front();
        }
    }

    EventPool& events_;
    std::deque<DeviceEvent> under_way_;  // of each update not known to have run, the newest last
};

}  // namespace throng
