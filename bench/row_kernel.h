// fill.comp and copy.comp: each invocation takes some rows of 16 bytes.
#pragma once

#include "gpu/kernel.h"

namespace throng::bench {

inline constexpr uint32_t kRow_bytes = 16;

class RowKernel {
public:
    RowKernel(const std::shared_ptr<Gpu>& gpu, std::string_view name, std::span<const uint32_t> plain,
              std::span<const uint32_t> software, uint32_t workgroup_size, uint32_t rows_per_invocation);

    Bindings bind(const BufferTable& buffers) const { return kernel_.bind(buffers); }
    void dispatch(VkCommandBuffer commands, const Bindings& bindings, uint32_t row_count) const;

private:
    uint32_t rows_per_invocation_;
    Kernel kernel_;
};
// Binding 0: what is written.
RowKernel fill_kernel(const std::shared_ptr<Gpu>& gpu, uint32_t workgroup_size, uint32_t rows_per_invocation);
// Binding 0: what is read, 1: what is written.
RowKernel copy_kernel(const std::shared_ptr<Gpu>& gpu, uint32_t workgroup_size, uint32_t rows_per_invocation);

}  // namespace throng::bench
