#include "crowd/first_uploads.h"

#include "gpu/barrier.h"

#include <utility>

namespace throng {

void FirstUploads::record(VkCommandBuffer commands) {
    if (state_ == State::kDone || has_event_) return;
    uploads.record(commands);
    state_ = State::kRecorded;
    if (!commands) return;
    if (!have_run_alone_)
        have_run_alone_ = Buffer(gpu_, "whether uploads have run", sizeof(uint32_t), 0, MemoryKind::kReadback);
    std::memset(have_run_alone_.mapped(), 0, sizeof(uint32_t));
    record_fill(*gpu_, commands, BufferRange(have_run_alone_), 1);
    memory_barrier(*gpu_, commands, kTransferWrite, kHostRead);
}

bool FirstUploads::have_run_alone() const {
    return have_run_alone_ && *reinterpret_cast<const volatile uint32_t*>(have_run_alone_.mapped()) != 0;
}

// Only updates set the event: a queue that only copies cannot.
void FirstUploads::begin_update(VkCommandBuffer commands) {
    poll();
    recorded_them_ = state_ == State::kPending || (state_ == State::kRecorded && may_be_dropped_ && !have_run_alone());
    if (recorded_them_) uploads.record(commands);
    if (recorded_them_) state_ = State::kRecorded;
    may_be_dropped_ = false;
    recorded_event_ = state_ == State::kRecorded && !has_event_;
    if (recorded_event_) have_run_.record_set(commands);
    has_event_ = has_event_ || recorded_event_;
}

void FirstUploads::discard_update() {
    if (std::exchange(recorded_them_, false))
        state_ = State::kPending;
    else
        may_be_dropped_ = recorded_event_;
    if (std::exchange(recorded_event_, false)) has_event_ = false;
}

void FirstUploads::poll() {
    if (state_ != State::kRecorded || !has_event_ || !have_run_.is_set()) return;
    uploads.complete();
    state_ = State::kDone;
}

void FirstUploads::finish() {
    if (state_ == State::kDone || has_event_) return;
    if (state_ == State::kRecorded) gpu_->wait_idle();
    if (have_run_alone()) {
        uploads.complete();
    } else if (gpu_->processor) {
        uploads.record(VK_NULL_HANDLE);
        uploads.complete();
    } else {
        uploads.finish();
    }
    state_ = State::kDone;
}

}  // namespace throng
