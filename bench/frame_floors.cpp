#include "bench/frame_floors.h"

#include "gpu/barrier.h"

#include <algorithm>

namespace throng::bench {
namespace {

// 256 MiB, the largest buffer of a crowd, are 16,384 workgroups: every device dispatches as many.
constexpr uint32_t kWorkgroupSize = 256, kRowsPerInvocation = 4;

uint32_t rows_of(uint64_t size_bytes) { return static_cast<uint32_t>(size_bytes / kRow_bytes); }

}  // namespace

FillFloor::FillFloor(const std::shared_ptr<Gpu>& gpu, const Crowd& crowd, SkinFormat format)
    : gpu_(gpu), kernel_(fill_kernel(gpu, kWorkgroupSize, kRowsPerInvocation)) {
    for (const OutputBlock& block : crowd.outputs()) {
        const uint64_t size_bytes = uint64_t{block.instance_count} * block.palette_count * skin_format_bytes(format);
        if (size_bytes < kRow_bytes) continue;
        targets_.push_back({block.skin.buffer, kernel_.bind({{0, BufferRange(block.skin.buffer, 0, size_bytes)}}),
                            rows_of(size_bytes)});
    }
}

uint64_t FillFloor::size_bytes() const {
    uint64_t sum = 0;
    for (const Target& target : targets_) sum += uint64_t{target.row_count} * kRow_bytes;
    return sum;
}

void FillFloor::record_kernel(VkCommandBuffer commands) const {
    for (const Target& target : targets_) kernel_.dispatch(commands, target.bindings, target.row_count);
}

void FillFloor::record_transfer(VkCommandBuffer commands) const {
    memory_barrier(*gpu_, commands, kShaderRead | kShaderWrite | kTransferWrite, kTransferWrite);
    for (const Target& target : targets_)
        gpu_->vk.vkCmdFillBuffer(commands, target.buffer, 0, uint64_t{target.row_count} * kRow_bytes, 0);
}

CopyFloor::CopyFloor(std::shared_ptr<Gpu> gpu, uint64_t moved_bytes, uint64_t buffer_bytes)
    : gpu_(std::move(gpu)), kernel_(copy_kernel(gpu_, kWorkgroupSize, kRowsPerInvocation)) {
    for (Buffer& buffer : buffers_)
        buffer = Buffer(gpu_, "bytes to copy", buffer_bytes, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT);
    for (size_t from = 0; from < buffers_.size(); ++from)
        bindings_[from] = kernel_.bind({{0, buffers_[from]}, {1, buffers_[1 - from]}});
    for (uint64_t left_bytes = moved_bytes / 2; left_bytes >= kRow_bytes;) {
        passes_.push_back({passes_.size() % 2, std::min(left_bytes, buffer_bytes) / kRow_bytes * kRow_bytes});
        left_bytes -= passes_.back().size_bytes;
    }
}

const char* CopyFloor::choose(const GpuClock& clock) {
    const auto min_ms = [&](bool by_kernel) {
        by_kernel_ = by_kernel;
        const auto run_ms = [&] { return clock.time_ms([&](VkCommandBuffer commands) { record(commands); }); };
        run_ms();  // compiles the kernel, and touches the memory
        return std::min(run_ms(), run_ms());
    };
    const double kernel_ms = min_ms(true), transfer_ms = min_ms(false);
    by_kernel_ = kernel_ms <= transfer_ms;
    return by_kernel_ ? "kernel" : "vkCmdCopyBuffer";
}

void CopyFloor::record(VkCommandBuffer commands) const {
    if (by_kernel_)
        record_kernel(commands);
    else
        record_transfer(commands);
}

void CopyFloor::wait_for_pass_before(VkCommandBuffer commands) const {
    constexpr Access kAny = kShaderRead | kShaderWrite | kTransferRead | kTransferWrite;
    memory_barrier(*gpu_, commands, kAny, kAny);
}

void CopyFloor::record_kernel(VkCommandBuffer commands) const {
    for (const CopyPass& pass : passes_) {
        wait_for_pass_before(commands);
        kernel_.dispatch(commands, bindings_[pass.from], rows_of(pass.size_bytes));
    }
}

void CopyFloor::record_transfer(VkCommandBuffer commands) const {
    for (const CopyPass& pass : passes_) {
        wait_for_pass_before(commands);
        const VkBufferCopy region{.srcOffset = 0, .dstOffset = 0, .size = pass.size_bytes};
        gpu_->vk.vkCmdCopyBuffer(commands, buffers_[pass.from].handle(), buffers_[1 - pass.from].handle(), 1, &region);
    }
}

}  // namespace throng::bench
