#include "crowd/first_uploads.h"

#include <utility>

namespace throng {

void FirstUploads::record(VkCommandBuffer commands) {
    if (state_ == State::kDone || has_event_) return;
    uploads.record(commands);
    state_ = State::kRecorded;
}

// Only updates set the event: a queue that only copies cannot.
void FirstUploads::begin_update(VkCommandBuffer commands) {
    poll();
    if (state_ == State::kPending) record(commands);
    recorded_event_ = !has_event_;
    if (recorded_event_) have_run_.record_set(commands);
    has_event_ = has_event_ || recorded_event_;
}

// The commands of record_uploads() may have been dropped together with the first update, so the next update uploads
// again. If they have run after all, this writes the same values once more, and overwrites what shaders have written
// since (OutputBlock::command).
void FirstUploads::discard_update() {
    if (!std::exchange(recorded_event_, false)) return;
    if (state_ == State::kRecorded) state_ = State::kPending;
    has_event_ = false;
}

void FirstUploads::poll() {
    if (state_ != State::kRecorded || !has_event_ || !have_run_.is_set()) return;
    uploads.complete();
    state_ = State::kDone;
}

void FirstUploads::finish() {
    if (state_ == State::kDone || has_event_) return;
    // What was recorded may have been dropped, so it is written once more, as in discard_update().
    if (state_ == State::kRecorded) gpu_->wait_idle();
    if (gpu_->processor) {
        uploads.record(VK_NULL_HANDLE);
        uploads.complete();
    } else {
        uploads.finish();
    }
    state_ = State::kDone;
}

}  // namespace throng
