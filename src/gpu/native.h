// A device without Vulkan: this machine's processor, which runs kernels as they are recorded.
#pragma once

#include "base/thread_pool.h"
#include "gpu/native_kernel.h"

#include <throng/device.h>
#include <throng/jobs.h>

#include <algorithm>
#include <memory>
#include <mutex>

namespace throng {

class NativeDevice {
public:
    static constexpr uint32_t kMaxThreads = 1024;

    // Uses `threads` and `jobs` of the settings.
    explicit NativeDevice(const DeviceSettings& settings);

    static DeviceInfo info(uint32_t index);
    static uint64_t memory_bytes();  // of this machine
    static VkPhysicalDeviceProperties properties();

    JobSystem& jobs() const;  // the application's; else a thread pool, made at the first call
    // Runs all workgroups, on as many threads as pay off; returns when they are done.
    void run(const NativeKernel& kernel, const NativeDispatch& dispatch, uint32_t workgroup_count) const;
    // Calls body(first, end) for parts of 0..count - 1, on as many threads as pay off; returns when all calls have
    // returned. Each part begins at a multiple of `least`, and has at least `least` items unless it is the last one.
    template <class Body>
    void for_parts(uint32_t count, uint32_t least, const Body& body) const {
        const uint64_t units = (uint64_t{count} + least - 1) / least;
        const auto parts = static_cast<uint32_t>(std::min<uint64_t>(units, part_limit()));
        const auto begin = [&](uint32_t i) {
            return static_cast<uint32_t>(std::min<uint64_t>(units * i / parts * least, count));
        };
        for_each_job(jobs(), parts, [&](uint32_t i) { body(begin(i), begin(i + 1)); });
    }

private:
    uint32_t part_limit() const;

    mutable std::shared_ptr<JobSystem> jobs_;
    mutable std::once_flag jobs_made_;
    uint32_t threads_ = 0;
};

// Memory of buffers, zero at first, at a multiple of 64 bytes.
class NativeMemory {
public:
    NativeMemory() = default;
    // Throws std::bad_alloc.
    explicit NativeMemory(uint64_t size_bytes);
    ~NativeMemory();
    NativeMemory(NativeMemory&& other) noexcept { *this = std::move(other); }
    NativeMemory& operator=(NativeMemory&& other) noexcept {
        std::swap(allocation_, other.allocation_);
        std::swap(bytes_, other.bytes_);
        return *this;
    }

    std::byte* bytes() const { return bytes_; }

private:
    void* allocation_ = nullptr;
    std::byte* bytes_ = nullptr;  // within allocation_, aligned
};

}  // namespace throng
