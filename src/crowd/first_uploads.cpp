#include "crowd/first_uploads.h"

namespace throng {

void FirstUploads::record(VkCommandBuffer commands) {
    if (state_ != State::kPending) return;
    uploads.record(commands);
    state_ = State::kRecorded;
}

// Only updates set the event: a queue that only copies cannot.
void FirstUploads::begin_update(VkCommandBuffer commands) {
    poll();
    recorded_them_ = state_ == State::kPending;
    record(commands);
    recorded_event_ = state_ == State::kRecorded && !has_event_;
    if (recorded_event_) have_run_.record_set(commands);
    has_event_ = has_event_ || recorded_event_;
}

void FirstUploads::discard_update() {
    if (recorded_them_) state_ = State::kPending;
    if (recorded_event_) has_event_ = false;
    recorded_them_ = recorded_event_ = false;
}

void FirstUploads::poll() {
    if (state_ != State::kRecorded || !has_event_ || !have_run_.is_set()) return;
    uploads.complete();
    state_ = State::kDone;
}

void FirstUploads::finish() {
    if (state_ == State::kRecorded && !has_event_) gpu_->wait_idle();  // which have no event of their own
    if (state_ != State::kPending) return;
    if (gpu_->processor) {
        uploads.record(VK_NULL_HANDLE);
        uploads.complete();
    } else {
        uploads.finish();
    }
    state_ = State::kDone;
}

}  // namespace throng
