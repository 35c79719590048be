// Milliseconds that recorded work takes on the GPU.
#pragma once

#include "gpu/gpu.h"

namespace throng::bench {

// What to believe of work that took `gpu_ms` by timestamps, and `host_ms` from its submission until it was waited for.
double believed_ms(const Gpu& gpu, double gpu_ms, double host_ms);

class GpuClock {
public:
    // Throws kUnsupported where the device has no timestamps.
    explicit GpuClock(std::shared_ptr<Gpu> gpu);
    ~GpuClock();
    GpuClock(const GpuClock&) = delete;
    GpuClock& operator=(const GpuClock&) = delete;

    // Submits what `work` records once, alone between two timestamps, and waits. It sees all work submitted before.
    double time_ms(const std::function<void(VkCommandBuffer)>& work) const;

private:
    double timestamps_ms(const std::function<void(VkCommandBuffer)>& work) const;

    std::shared_ptr<Gpu> gpu_;
    VkQueryPool pool_ = VK_NULL_HANDLE;
};

}  // namespace throng::bench
