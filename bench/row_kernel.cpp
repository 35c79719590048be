#include "bench/row_kernel.h"

namespace throng::bench {
namespace {

constexpr uint32_t kFillPlain[] = {
#include "bench/fill.inc"
};
constexpr uint32_t kFillSoftware[] = {
#include "bench/fill.software.inc"
};
constexpr uint32_t kCopyPlain[] = {
#include "bench/copy.inc"
};
constexpr uint32_t kCopySoftware[] = {
#include "bench/copy.software.inc"
};

}  // namespace

RowKernel::RowKernel(const std::shared_ptr<Gpu>& gpu, std::string_view name, std::span<const uint32_t> plain,
                     std::span<const uint32_t> software, uint32_t workgroup_size, uint32_t rows_per_invocation)
    : rows_per_invocation_(rows_per_invocation),
      kernel_(gpu, {.name = name,
                    .spirv = gpu->uses_software_kernels() ? software : plain,
                    .workgroup_size = workgroup_size,
                    .constants = {rows_per_invocation}}) {}

void RowKernel::dispatch(VkCommandBuffer commands, const Bindings& bindings, uint32_t row_count) const {
    kernel_.dispatch_invocations(commands, bindings, row_count,
                                 (row_count + rows_per_invocation_ - 1) / rows_per_invocation_);
}

RowKernel fill_kernel(const std::shared_ptr<Gpu>& gpu, uint32_t workgroup_size, uint32_t rows_per_invocation) {
    return {gpu, "fill", kFillPlain, kFillSoftware, workgroup_size, rows_per_invocation};
}

RowKernel copy_kernel(const std::shared_ptr<Gpu>& gpu, uint32_t workgroup_size, uint32_t rows_per_invocation) {
    return {gpu, "copy", kCopyPlain, kCopySoftware, workgroup_size, rows_per_invocation};
}

}  // namespace throng::bench
