// Milliseconds that recorded work takes on the GPU.
#pragma once

#include "bench/gpu_load.h"
#include "gpu/timestamps.h"

namespace throng::bench {

struct Reading {
    double ms = 0;
    bool by_host = false;  // timestamps were not credible
};

// The credible reading for work that took `gpu_ms` by timestamps, and `host_ms` from its submission to the end of the
// wait.
Reading credible_reading(const Gpu& gpu, double gpu_ms, double host_ms);

class GpuClock {
public:
    // Throws kUnsupported where the device has no timestamps.
    explicit GpuClock(std::shared_ptr<Gpu> gpu);

    // Submits what `work` records once, alone between two timestamps, and waits; keeps the GPU busy just before. The
    // work sees the results of all earlier submissions.
    Reading read(const std::function<void(VkCommandBuffer)>& work) const;
    const GpuLoad& load() const { return load_; }
    double time_ms(const std::function<void(VkCommandBuffer)>& work) const { return read(work).ms; }

private:
    std::shared_ptr<Gpu> gpu_;
    std::unique_ptr<Timestamps> timestamps_;
    GpuLoad load_;
};

}  // namespace throng::bench
