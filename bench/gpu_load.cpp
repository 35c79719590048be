#include "bench/gpu_load.h"

#include "gpu/barrier.h"

namespace throng::bench {
namespace {

// Small, so that the next sample finds the caches nearly as the previous one left them
constexpr uint32_t kBuffer_bytes = 2u << 20;

}  // namespace

GpuLoad::Work::Work(const std::shared_ptr<Gpu>& gpu)
    : kernel(copy_kernel(gpu, 256, 4)),
      buffers{Buffer(gpu, "load", kBuffer_bytes, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT),
              Buffer(gpu, "load", kBuffer_bytes, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT)},
      bindings(kernel.bind({{0, buffers[0]}, {1, buffers[1]}})) {}

GpuLoad::GpuLoad(const std::shared_ptr<Gpu>& gpu) : gpu_(gpu) {
    if (!gpu->is_cpu() && !gpu->is_native()) work_ = std::make_unique<const Work>(gpu);
}

void GpuLoad::run() const {
    if (!work_) return;
    constexpr uint32_t kCopies = 200;
    constexpr double kBusy_s = 0.003, kIdle_s = 0.02, kRampUp_s = 0.1;
    const double min_s = since_last_ && since_last_->elapsed_s() < kIdle_s ? kBusy_s : kRampUp_s;
    const Stopwatch watch;
    do
        gpu_->submit_and_wait([&](VkCommandBuffer commands) {
            for (uint32_t i = 0; i < kCopies; ++i) {
                memory_barrier(*gpu_, commands, kShaderRead | kShaderWrite, kShaderRead | kShaderWrite);
                work_->kernel.dispatch(commands, work_->bindings, kBuffer_bytes / kRow_bytes);
            }
        });
    while (watch.elapsed_s() < min_s);
    since_last_.emplace();
}

}  // namespace throng::bench
