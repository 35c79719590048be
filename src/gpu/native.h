// A device without Vulkan: this machine's processor, which runs kernels where they are recorded.
#pragma once

#include "gpu/native_kernel.h"

#include <throng/device.h>
#include <throng/jobs.h>

#include <memory>
#include <mutex>

namespace throng {

class NativeDevice {
public:
    // As DeviceSettings has them.
    explicit NativeDevice(const DeviceSettings& settings);

    static DeviceInfo info(uint32_t index);
    static uint64_t memory_bytes();  // of this machine
    static VkPhysicalDeviceProperties properties();

    JobSystem& jobs() const;  // made at the first call, where they are the device's own
    // All workgroups, on as many threads as are worth it; returns when they are done.
    void run(const NativeKernel& kernel, const NativeDispatch& dispatch, uint32_t workgroup_count) const;

private:
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
        std::swap(bytes_, other.bytes_);
        return *this;
    }

    std::byte* bytes() const { return bytes_; }

private:
    std::byte* bytes_ = nullptr;
};

}  // namespace throng
