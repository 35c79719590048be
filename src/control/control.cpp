#include "control/control.h"

namespace throng {
namespace {

constexpr uint32_t kPlain[] = {
#include "control/control.comp.inc"
};
constexpr uint32_t kWide[] = {
#include "control/control.wide.inc"
};

}  // namespace

Kernel control_kernel(const std::shared_ptr<Gpu>& gpu) {
    return Kernel(gpu,
                  {.name = "control", .spirv = gpu->prefers_wide_words() ? std::span<const uint32_t>(kWide) : kPlain});
}

}  // namespace throng
