#include "draw/frame_uploads.h"

#include "gpu/barrier.h"

#include <algorithm>

namespace throng {

void FrameUploads::add(std::unique_ptr<Uploads> uploads) {
    if (!uploads->is_empty()) pending_.push_back({.uploads = std::move(uploads)});
}

void FrameUploads::record(VkCommandBuffer commands) {
    poll();
    if (pending_.empty()) return;
    const uint64_t number = ++frame_count_;
    // Frames that have recorded them already may still copy, and draw.
    if (std::ranges::any_of(pending_, [](const Pending& pending) { return !pending.has_run; }))
        memory_barrier(*gpu_, commands, kAnyAccess, kTransferWrite);
    for (Pending& pending : pending_) {
        if (pending.has_run) continue;
        pending.uploads->record(commands);
        if (pending.first_frame == 0) pending.first_frame = number;
        pending.last_frame = number;
    }
    frames_.push_back({number, events_.take()});
    frames_.back().done.record_set_behind_all(commands);
}

// When a frame has run, earlier ones have too, or never will.
void FrameUploads::poll() {
    uint64_t newest = 0;
    for (const Frame& frame : frames_) {
        if (!frame.done.is_set()) continue;
        newest = std::max(newest, frame.number);
        for (Pending& pending : pending_)
            pending.has_run = pending.has_run ||
                              (pending.first_frame <= frame.number && frame.number <= pending.last_frame);
    }
    while (!frames_.empty() && frames_.front().number <= newest) {
        DeviceEvent done = std::move(frames_.front().done);
        frames_.pop_front();
        events_.give_back(std::move(done));
    }
    // The events would do, but validation layers do not follow them: see Retired.
    std::erase_if(pending_, [&](Pending& pending) {
        return pending.has_run && pending.last_frame <= newest && --pending.frames_left == 0;
    });
}

}  // namespace throng
