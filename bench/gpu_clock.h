// Milliseconds that recorded work takes on the GPU.
#pragma once

#include "gpu/timestamps.h"

namespace throng::bench {

struct Reading {
    double ms = 0;
    bool by_host = false;  // timestamps were not to be believed
};

// What to believe of work that took `gpu_ms` by timestamps, and `host_ms` from its submission until it was waited for.
Reading believed_reading(const Gpu& gpu, double gpu_ms, double host_ms);

class GpuClock {
public:
    // Throws kUnsupported where the device has no timestamps.
    explicit GpuClock(std::shared_ptr<Gpu> gpu);

    // Submits what `work` records once, alone between two timestamps, and waits. It sees all work submitted before.
    Reading read(const std::function<void(VkCommandBuffer)>& work) const;
    double time_ms(const std::function<void(VkCommandBuffer)>& work) const { return read(work).ms; }

private:
    double timestamps_ms(const std::function<void(VkCommandBuffer)>& work) const;

    std::shared_ptr<Gpu> gpu_;
    mutable Timestamps stamps_;
};

}  // namespace throng::bench
