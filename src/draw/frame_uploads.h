// Uploads that a renderer's frames record, so that nothing is submitted for them.
#pragma once

#include "gpu/event.h"
#include "gpu/upload.h"

#include <deque>
#include <memory>
#include <vector>

namespace throng {

class FrameUploads {
public:
    explicit FrameUploads(std::shared_ptr<Gpu> gpu) : gpu_(std::move(gpu)), events_(gpu_) {}

    // To be recorded by the frames from the next one on. They keep alive what they upload to.
    void add(std::unique_ptr<Uploads> uploads);
    // Once a frame, before anything that reads what they fill; outside of render passes. The commands of a frame may be
    // dropped, and nothing tells so: the uploads are recorded into each frame until an event says that one has run.
    void record(VkCommandBuffer commands);

private:
    struct Pending {
        std::unique_ptr<Uploads> uploads;
        uint64_t first_frame = 0, last_frame = 0;  // that record them; 0: none yet
        bool has_run = false;
        // Until the staging memory is freed. An application may draw several pictures for each frame of its own
        uint32_t frames_left = 16;
    };
    struct Frame {
        uint64_t number = 0;
        DeviceEvent done;
    };
    void poll();

    std::shared_ptr<Gpu> gpu_;
    EventPool events_;
    std::vector<Pending> pending_;
    std::deque<Frame> frames_;  // that are not known to have run, nor to have been dropped
    uint64_t frame_count_ = 0;
};

}  // namespace throng
