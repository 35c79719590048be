// A compute shader, ready to dispatch.
#pragma once

#include "gpu/shader.h"

namespace throng {

class CompiledKernel;

struct KernelSettings {
    std::string_view name;                 // for messages
    std::span<const uint32_t> spirv;       // static: a pipeline may be made of it later
    uint32_t workgroup_size = 0;           // constant_id 0; 0 where the shader fixes its own
    std::vector<uint32_t> constants = {};  // constant_id 1, 2, …
    uint32_t subgroup_size = 0;            // asked for, where Gpu::can_choose_subgroup; 0: the device chooses
    bool full_subgroups = false;           // no idle invocations in them, where the device can promise it
    const NativeKernel* native = nullptr;  // what Gpu::processor runs; null: nothing
};

// Makes the pipelines of all existing kernels that have none yet. Thread-safe.
void make_pipelines(Gpu& gpu);

// A handle: kernels of one device that are made from the same code and settings share one pipeline
// (gpu/shared_kernels.h).
class Kernel {
public:
    Kernel() = default;
    Kernel(std::shared_ptr<Gpu> gpu, const KernelSettings& settings);
    Kernel(Kernel&& other) noexcept { *this = std::move(other); }
    Kernel& operator=(Kernel&& other) noexcept {  // swaps, so that what is compiled is freed before its device
        std::swap(gpu_, other.gpu_);
        std::swap(name_, other.name_);
        std::swap(compiled_, other.compiled_);
        std::swap(native_, other.native_);
        std::swap(constants_, other.constants_);
        std::swap(workgroup_size_, other.workgroup_size_);
        return *this;
    }

    uint32_t workgroup_size() const { return workgroup_size_; }

    // Binds the buffers that the shader names. Throws kInvalidArgument if the table has neither one of them nor a
    // stand-in.
    Bindings bind(const BufferTable& buffers) const;

    // One workgroup for each of `count` items, or one invocation for each. `push` is the shader's whole push-constant
    // block. Throws kLimit if the device cannot dispatch that many, and kInvalidArgument if the block's size differs
    // from the shader's.
    template <class Push>
    void dispatch_workgroups(VkCommandBuffer commands, const Bindings& bindings, const Push& push,
                             uint32_t count) const {
        dispatch(commands, bindings, &push, sizeof push, count);
    }
    template <class Push>
    void dispatch_invocations(VkCommandBuffer commands, const Bindings& bindings, const Push& push,
                              uint32_t count) const {
        dispatch(commands, bindings, &push, sizeof push, (count + workgroup_size_ - 1) / workgroup_size_);
    }
    // As many workgroups as the `command`-th VkDispatchIndirectCommand of the buffer says.
    template <class Push>
    void dispatch_indirect(VkCommandBuffer commands, const Bindings& bindings, const Push& push,
                           const Buffer& workgroups, uint32_t command) const {
        dispatch_indirect(
            commands, bindings, &push, sizeof push,
            BufferRange(workgroups, command * sizeof(VkDispatchIndirectCommand), sizeof(VkDispatchIndirectCommand)));
    }

private:
    void dispatch(VkCommandBuffer commands, const Bindings& bindings, const void* push, size_t push_bytes,
                  uint32_t workgroup_count) const;
    void dispatch_indirect(VkCommandBuffer commands, const Bindings& bindings, const void* push, size_t push_bytes,
                           const BufferRange& workgroups) const;
    void run_native(const Bindings& bindings, const void* push, size_t push_bytes, uint32_t workgroup_count) const;
    void check_push(size_t expected_bytes, size_t push_bytes) const;
    void prepare(VkCommandBuffer commands, const Bindings& bindings, const void* push, size_t push_bytes) const;

    std::shared_ptr<Gpu> gpu_;
    std::string name_;
    std::shared_ptr<const CompiledKernel> compiled_;  // null on a native device
    const NativeKernel* native_ = nullptr;            // where there is Gpu::processor
    std::vector<uint32_t> constants_;                 // of native_: constant_id 0, 1, …
    uint32_t workgroup_size_ = 0;
};

}  // namespace throng
