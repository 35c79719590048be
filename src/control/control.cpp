#include "control/control.h"

namespace throng {
namespace {

constexpr uint32_t kSpirv[] = {
#include "control/control.comp.inc"
};

}  // namespace

Kernel control_kernel(const std::shared_ptr<Gpu>& gpu) { return Kernel(gpu, {.name = "control", .spirv = kSpirv}); }

}  // namespace throng
