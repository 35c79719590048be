// The compiled code of a kernel. throng_add_kernel() (cmake/shaders.cmake) makes a KernelCode for each.
#pragma once

#include "gpu/kernel.h"
#include "gpu/native_kernel.h"

namespace throng {

struct KernelCode {
    std::string_view name;
    std::span<const uint32_t> plain, software;  // the same where there is only one variant
    const NativeKernel* native = nullptr;       // null: not available without Vulkan

    Kernel on(const std::shared_ptr<Gpu>& gpu, std::vector<uint32_t> constants = {}) const {
        return Kernel(gpu, {.name = name,
                            .spirv = gpu->uses_software_kernels() ? software : plain,
                            .constants = std::move(constants),
                            .native = native});
    }
};

}  // namespace throng
