// GPU time of the draw, of frames that may follow each other before the first has finished.
#pragma once

#include "draw/owned.h"

namespace throng {

class DrawTimer {
public:
    // Submits and waits. Without timestamps all times are 0.
    explicit DrawTimer(std::shared_ptr<Gpu> gpu);

    // Once a frame each, outside of render passes: where it draws occluders first, around these, then around the rest.
    void begin_occluders(VkCommandBuffer commands);
    void end_occluders(VkCommandBuffer commands) const { write(commands, 1); }
    void begin(VkCommandBuffer commands);
    void end(VkCommandBuffer commands) const { write(commands, 3); }
    // Of the last frame that has finished; 0 where none has.
    double read_ms() const;

private:
    static constexpr uint32_t kFrames = 4;  // whose times are kept; that many may be in flight
    static constexpr uint32_t kStamps = 4;  // of a frame
    void write(VkCommandBuffer commands, uint32_t stamp) const;

    std::shared_ptr<Gpu> gpu_;
    OwnedQueries queries_;  // [kFrames][kStamps]
    uint32_t frame_ = 0;    // the last that has begun
    bool has_occluders_ = false;  // it has, and the rest is to come
};

}  // namespace throng
