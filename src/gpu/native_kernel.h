// A kernel as devices without Vulkan run it: the text of its shader, compiled as C++.
#pragma once

#include "gpu/buffers_io.h"

#include <array>
#include <cstddef>
#include <span>

namespace throng {

struct NativeDispatch {
    std::array<std::byte*, io::kBufferCount> buffers{};  // by their numbers; null: the kernel does not use it
    std::span<const uint32_t> constants;  // constant_id 0, 1, …; missing ones have the shader's defaults
    const void* push = nullptr;
};

struct NativeKernel {
    uint32_t workgroup_size = 0;  // 0: the value of constant 0
    uint32_t push_bytes = 0;
    // Runs workgroups first_workgroup..end_workgroup - 1 on the calling thread, one after another.
    void (*run)(const NativeDispatch& dispatch, uint32_t first_workgroup, uint32_t end_workgroup) = nullptr;
};

}  // namespace throng
