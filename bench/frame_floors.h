// What memory alone costs an update: writing its result, and moving the bytes that the stages move between them.
#pragma once

#include "bench/gpu_clock.h"
#include "bench/row_kernel.h"

#include <throng/crowd.h>

namespace throng::bench {

// Overwrites the skin matrices of a crowd, in the crowd's own buffers. They must have been checked before.
class FillFloor {
public:
    FillFloor(const std::shared_ptr<Gpu>& gpu, const Crowd& crowd, SkinFormat format);

    uint64_t size_bytes() const;  // of what is written
    void record_kernel(VkCommandBuffer commands) const;
    void record_transfer(VkCommandBuffer commands) const;  // vkCmdFillBuffer

private:
    struct Target {
        VkBuffer buffer = VK_NULL_HANDLE;
        Bindings bindings;
        uint32_t row_count = 0;
    };
    std::shared_ptr<Gpu> gpu_;
    RowKernel kernel_;
    std::vector<Target> targets_;
};

// Copies back and forth between two buffers of `buffer_bytes`: half of `moved_bytes` is read, half written. Each pass
// reads what the one before it wrote, as stages do, so that caches help both alike.
struct CopyPass {
    size_t from = 0;  // number of the buffer to read
    uint64_t size_bytes = 0;
};

class CopyFloor {
public:
    // In whole rows of 16 bytes; `buffer_bytes` is at least one row.
    CopyFloor(std::shared_ptr<Gpu> gpu, uint64_t moved_bytes, uint64_t buffer_bytes);

    // Measures whether a kernel or the device's own copy is faster here; record() then uses that one. Returns its name.
    const char* choose(const GpuClock& clock);
    void record(VkCommandBuffer commands) const;
    void record_kernel(VkCommandBuffer commands) const;
    void record_transfer(VkCommandBuffer commands) const;

    const std::vector<CopyPass>& passes() const { return passes_; }
    const std::array<Buffer, 2>& buffers() const { return buffers_; }

private:
    void wait_for_pass_before(VkCommandBuffer commands) const;

    std::shared_ptr<Gpu> gpu_;
    std::vector<CopyPass> passes_;
    bool by_kernel_ = true;
    std::array<Buffer, 2> buffers_;
    RowKernel kernel_;
    std::array<Bindings, 2> bindings_;  // [buffer to read]
};

}  // namespace throng::bench
