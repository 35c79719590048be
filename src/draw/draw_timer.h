// GPU time of the draw, of frames that may follow each other before the first has finished.
#pragma once

#include "draw/owned.h"

namespace throng {

class DrawTimer {
public:
    // Submits and waits. Without timestamps all times are 0.
    explicit DrawTimer(std::shared_ptr<Gpu> gpu);

    // Once a frame each, outside of render passes.
    void begin(VkCommandBuffer commands);
    void end(VkCommandBuffer commands) const;
    // Of the last frame that has finished; 0 where none has.
    double read_ms() const;

private:
    static constexpr uint32_t kFrames = 4;  // whose times are kept; that many may be in flight

    std::shared_ptr<Gpu> gpu_;
    OwnedQueries queries_;  // [kFrames][begin, end]
    uint32_t frame_ = 0;    // of the last begin()
};

}  // namespace throng
