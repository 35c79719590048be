// The first contents of a crowd's buffers. Making a crowd submits nothing: they are recorded into the first update, or
// before it into commands of the application's.
#pragma once

#include "gpu/event.h"
#include "gpu/upload.h"

namespace throng {

class FirstUploads {
public:
    FirstUploads(const std::shared_ptr<Gpu>& gpu, EventPool& events)
        : uploads(gpu, Uploads::kUnlimited_bytes), gpu_(gpu), have_run_(events.take()) {}

    Uploads uploads;  // to be filled before any of the calls

    // Records the uploads alone, each time until an update has been recorded.
    void record(VkCommandBuffer commands);
    // At the beginning of an update: records them unless that has been done.
    void begin_update(VkCommandBuffer commands);
    // The last update will never be submitted, and perhaps nor will what record() has recorded before it.
    void discard_update();
    // Frees the staging memory once they have run.
    void poll();
    bool is_done() const { return state_ == State::kDone; }
    DeviceEvent take_event() { return std::move(have_run_); }  // when it is done
    // Whether the commands of a first update that was recorded are known to have run.
    bool first_update_has_run() const { return has_event_ && have_run_.is_set(); }
    // Called before something is read or restored. Unless an update has been recorded, waits for what has been recorded
    // alone, then submits them and waits; on a software device the processor copies, since nobody uses the buffers yet.
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
