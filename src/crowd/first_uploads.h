// The first contents of a crowd's buffers. Making a crowd submits nothing: the uploads are recorded into the first
// update or, before it, into commands of the application.
#pragma once

#include "gpu/event.h"
#include "gpu/upload.h"

namespace throng {

class FirstUploads {
public:
    FirstUploads(const std::shared_ptr<Gpu>& gpu, EventPool& events)
        : uploads(gpu, Uploads::kUnlimited_bytes), gpu_(gpu), have_run_(events.take()) {}

    Uploads uploads;  // to be filled before any of the calls

    // Records the uploads by themselves. Until an update has been recorded, each call records them again.
    void record(VkCommandBuffer commands);
    // At the beginning of an update: records them unless that has been done.
    void begin_update(VkCommandBuffer commands);
    // The last update will never be submitted, and perhaps neither will the commands that record() was given before it.
    void discard_update();
    // Frees the staging memory once they have run.
    void poll();
    bool is_done() const { return state_ == State::kDone; }
    DeviceEvent take_event() { return std::move(have_run_); }  // when it is done
    // Whether the commands of a first update that was recorded are known to have run.
    bool first_update_has_run() const { return has_event_ && have_run_.is_set(); }
    // Called before something is read or restored. Unless an update has been recorded, waits for what record() has
    // recorded, then submits the uploads and waits. On a software device the CPU copies them, since nothing uses the
    // buffers yet.
    void finish();

private:
    enum class State { kPending, kRecorded, kDone };

    std::shared_ptr<Gpu> gpu_;
    State state_ = State::kPending;
    DeviceEvent have_run_;  // set by the first update
    bool has_event_ = false;
    bool recorded_event_ = false;  // by the last update, which may be discarded
};

}  // namespace throng
