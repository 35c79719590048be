// GPU time of the draw, of frames that may follow each other before the first has finished.
#pragma once

#include "gpu/timestamps.h"

namespace throng {

class DrawTimer {
public:
    // Without timestamps all times are 0.
    explicit DrawTimer(const std::shared_ptr<Gpu>& gpu);

    // Once a frame each, outside of render passes: where it draws occluders first, around these, then around the rest.
    void begin_occluders(VkCommandBuffer commands);
    void end_occluders(VkCommandBuffer commands) { write(commands); }
    void begin(VkCommandBuffer commands);
    void end(VkCommandBuffer commands);
    // Of the newest frame that has finished; 0 where none has. Does not wait.
    double read_ms() const;

private:
    void write(VkCommandBuffer commands);

    std::optional<Timestamps> stamps_;
    bool has_occluders_ = false;  // the frame has, and the rest is to come
};

}  // namespace throng
