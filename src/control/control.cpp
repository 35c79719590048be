#include "control/control.h"

namespace throng {
namespace {

constexpr uint32_t kPlain[] = {
#include "control/control.comp.inc"
};
constexpr uint32_t kSoftware[] = {
#include "control/control.software.inc"
};

}  // namespace

Kernel control_kernel(const std::shared_ptr<Gpu>& gpu) {
    return Kernel(gpu, {.name = "control",
                        .spirv = gpu->uses_software_kernels() ? std::span<const uint32_t>(kSoftware) : kPlain});
}

}  // namespace throng
