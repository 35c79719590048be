#include "bind/bind.h"

namespace throng {
namespace {

constexpr uint32_t kPlain[] = {
#include "bind/bind.comp.inc"
};
constexpr uint32_t kSoftware[] = {
#include "bind/bind.software.inc"
};

}  // namespace

Kernel bind_kernel(const std::shared_ptr<Gpu>& gpu, SkinFormat format) {
    return Kernel(gpu, {.name = "bind",
                        .spirv = gpu->uses_software_kernels() ? std::span<const uint32_t>(kSoftware) : kPlain,
                        .constants = {static_cast<uint32_t>(format)}});
}

}  // namespace throng
