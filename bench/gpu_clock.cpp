#include "bench/gpu_clock.h"

#include "base/failure.h"
#include "gpu/barrier.h"

namespace throng::bench {

GpuClock::GpuClock(std::shared_ptr<Gpu> gpu) : gpu_(std::move(gpu)), load_(gpu_) {
    if (!gpu_->has_timestamps())
        throw Failure(ErrorCode::kUnsupported, gpu_->info.name, "the device has no timestamps to measure with");
    timestamps_ = std::make_unique<Timestamps>(gpu_, 2);
}

// On a busy machine lavapipe's timestamps were seen to span a fifth of the host's time or less, probably because the
// thread that writes them is not the one that computes. In this case the host's clock is used, which includes the
// submission. Work is never submitted again for another try, because an update changes the crowd's state.
Reading credible_reading(const Gpu& gpu, double gpu_ms, double host_ms) {
    constexpr double kSubmission_ms = 0.5;
    const bool by_host = gpu.is_cpu() && gpu_ms < 0.5 * (host_ms - kSubmission_ms);
    return {by_host ? host_ms : gpu_ms, by_host};
}

Reading GpuClock::read(const std::function<void(VkCommandBuffer)>& work) const {
    load_.run();
    const Stopwatch watch;
    gpu_->submit_and_wait([&](VkCommandBuffer commands) {
        timestamps_->begin(commands);
        memory_barrier(*gpu_, commands, kTransferWrite | kShaderRead | kShaderWrite, kShaderRead | kShaderWrite);
        timestamps_->write(commands);
        work(commands);
        timestamps_->write(commands);
        timestamps_->publish(commands);
    });
    return credible_reading(*gpu_, timestamps_->newest().value().ms[1], watch.elapsed_s() * 1e3);
}

}  // namespace throng::bench
