#include "control/controller_kernel.h"

namespace throng {
namespace {

constexpr uint32_t kController[] = {
#include "control/controller.comp.inc"
};
constexpr uint32_t kControllerWide[] = {
#include "control/controller.wide.inc"
};
constexpr uint32_t kCommands[] = {
#include "control/commands.comp.inc"
};

}  // namespace

Kernel controller_kernel(const std::shared_ptr<Gpu>& gpu) {
    return Kernel(gpu, {.name = "controller",
                        .spirv = gpu->prefers_wide_words() ? std::span<const uint32_t>(kControllerWide) : kController});
}

Kernel command_kernel(const std::shared_ptr<Gpu>& gpu) { return Kernel(gpu, {.name = "commands", .spirv = kCommands}); }

}  // namespace throng
