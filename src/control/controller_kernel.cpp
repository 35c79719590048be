#include "control/controller_kernel.h"

namespace throng {
namespace {

constexpr uint32_t kController[] = {
#include "control/controller.comp.inc"
};
constexpr uint32_t kControllerSoftware[] = {
#include "control/controller.software.inc"
};
constexpr uint32_t kCommands[] = {
#include "control/commands.comp.inc"
};

}  // namespace

Kernel controller_kernel(const std::shared_ptr<Gpu>& gpu) {
    return Kernel(
        gpu, {.name = "controller",
              .spirv = gpu->uses_software_kernels() ? std::span<const uint32_t>(kControllerSoftware) : kController});
}

Kernel command_kernel(const std::shared_ptr<Gpu>& gpu) { return Kernel(gpu, {.name = "commands", .spirv = kCommands}); }

}  // namespace throng
