#include "sample/sample.h"

namespace throng {
namespace {

constexpr uint32_t kPlain[] = {
#include "sample/sample.comp.inc"
};
constexpr uint32_t kSoftware[] = {
#include "sample/sample.software.inc"
};

}  // namespace

Kernel sample_kernel(const std::shared_ptr<Gpu>& gpu, bool packed) {
    return Kernel(gpu, {.name = "sample",
                        .spirv = gpu->uses_software_kernels() ? std::span<const uint32_t>(kSoftware) : kPlain,
                        .constants = {packed ? 1u : 0u}});
}

}  // namespace throng
