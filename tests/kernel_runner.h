// Runs one kernel over buffers that have guard words behind them.
#pragma once

#include "gpu/barrier.h"
#include "gpu/kernel.h"
#include "gpu/upload.h"
#include "tests/test_device.h"

#include <throng/outputs.h>

#include <algorithm>
#include <cstring>
#include <span>
#include <utility>
#include <vector>

namespace throng::test {

inline const std::shared_ptr<Gpu>& test_gpu() { return test_device().gpu(); }

// Values that a kernel is to overwrite: every float in them is NaN.
template <class T>
std::vector<T> poison(size_t count) {
    std::vector<T> out(count);
    if (count > 0) std::memset(static_cast<void*>(out.data()), 0xFF, count * sizeof(T));
    return out;
}

// Values on the device, followed by guard words, which a kernel overwrites if it writes too far. The guard words are
// inside the bound range, since the software device discards writes beyond it.
template <class T>
class Guarded {
public:
    explicit Guarded(const std::vector<T>& values) : size_bytes_(values.size() * sizeof(T)) {
        std::vector<std::byte> bytes(size_bytes_ + kGuard_bytes, kGuard);
        if (size_bytes_ > 0) std::memcpy(bytes.data(), values.data(), size_bytes_);
        buffer_ = upload(test_gpu(), "test", bytes,
                         VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT);
        if (sizeof(T) == 4 || sizeof(T) % 16 == 0) buffer_.allow_texels(sizeof(T) == 4 ? 4 : 16);
    }
    operator BufferRange() const { return BufferRange(buffer_); }

    // The current values. Fails the test if a guard word has changed.
    std::vector<T> read() const {
        const std::vector<std::byte> bytes = download<std::byte>(test_gpu(), buffer_);
        std::vector<T> out(size_bytes_ / sizeof(T));
        if (size_bytes_ > 0) std::memcpy(static_cast<void*>(out.data()), bytes.data(), size_bytes_);
        EXPECT_TRUE(std::all_of(bytes.begin() + static_cast<ptrdiff_t>(size_bytes_), bytes.end(), [](std::byte b) {
            return b == kGuard;
        })) << "guard words overwritten";
        return out;
    }

private:
    static constexpr size_t kGuard_bytes = 4096;
    static constexpr std::byte kGuard{0xA5};

    size_t size_bytes_ = 0;
    Buffer buffer_;
};

// An output of a crowd: in its buffer, or on a native device in host memory. Empty if the crowd has neither.
inline BufferRange output_range(const OutputBlock& block, BufferView OutputBlock::*member, VkDeviceSize offset_bytes,
                                VkDeviceSize size_bytes) {
    const HostOutputs& host = block.host;
    const auto commands = std::span(reinterpret_cast<const std::byte*>(host.command_head.data()),
                                    host.command_head.size_bytes() + host.command.size_bytes());
    const std::pair<BufferView OutputBlock::*, std::span<const std::byte>> all[]{
        {&OutputBlock::skin, host.skin},
        {&OutputBlock::previous_skin, host.previous_skin},
        {&OutputBlock::model, std::as_bytes(host.model)},
        {&OutputBlock::placement, std::as_bytes(host.placement)},
        {&OutputBlock::socket, std::as_bytes(host.socket)},
        {&OutputBlock::parameter, std::as_bytes(host.parameter)},
        {&OutputBlock::root, std::as_bytes(host.root)},
        {&OutputBlock::target, std::as_bytes(host.target)},
        {&OutputBlock::destination, std::as_bytes(host.destination)},
        {&OutputBlock::morph, std::as_bytes(host.morph)},
        {&OutputBlock::look, std::as_bytes(host.look)},
        {&OutputBlock::command, commands},
        {&OutputBlock::list, std::as_bytes(host.list)},
        {&OutputBlock::skinned, std::as_bytes(host.skinned)}};
    const BufferView& view = block.*member;
    EXPECT_LE(view ? offset_bytes + size_bytes : 0, view.size_bytes);
    BufferRange range(view.buffer, view.offset_bytes + offset_bytes, size_bytes);
    for (const auto& [of, bytes] : all) {
        if (of != member || bytes.empty()) continue;
        EXPECT_LE(offset_bytes + size_bytes, bytes.size());
        range.mapped = const_cast<std::byte*>(bytes.data());
    }
    return range;
}

template <class T>
std::vector<T> output(const OutputBlock& block, BufferView OutputBlock::*member, uint64_t count,
                      const std::shared_ptr<Gpu>& gpu = test_gpu()) {
    return download<T>(gpu, output_range(block, member, 0, count * sizeof(T)));
}

inline bool has_output(const OutputBlock& block, BufferView OutputBlock::*member) {
    return bool(output_range(block, member, 0, 0));
}

// For vectors or spans.
template <class Values>
bool same_bits(const Values& a, const Values& b) {
    return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(a[0])) == 0);
}

// Submits what `body` records, after uploads and earlier kernels, and waits.
template <class Body>
void run_on_gpu(Body&& body) {
    const Gpu& gpu = *test_gpu();
    gpu.submit_and_wait([&](VkCommandBuffer commands) {
        memory_barrier(gpu, commands, kTransferWrite | kShaderWrite, kShaderRead | kShaderWrite);
        body(commands);
    });
}

template <class Push>
void run_workgroups(const Kernel& kernel, const BufferTable& buffers, const Push& push, uint32_t count) {
    const Bindings bindings = kernel.bind(buffers);
    run_on_gpu([&](VkCommandBuffer commands) { kernel.dispatch_workgroups(commands, bindings, push, count); });
}

template <class Push>
void run_invocations(const Kernel& kernel, const BufferTable& buffers, const Push& push, uint32_t count) {
    const Bindings bindings = kernel.bind(buffers);
    run_on_gpu([&](VkCommandBuffer commands) { kernel.dispatch_invocations(commands, bindings, push, count); });
}

}  // namespace throng::test
