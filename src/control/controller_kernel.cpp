#include "control/controller_kernel.h"

#include "shaders.h"

namespace throng {

Kernel controller_kernel(const std::shared_ptr<Gpu>& gpu) {
    return Kernel(gpu, {.name = "controller", .spirv = shaders::controller.words(*gpu)});
}

Kernel command_kernel(const std::shared_ptr<Gpu>& gpu) {
    return Kernel(gpu, {.name = "commands", .spirv = shaders::commands.words(*gpu)});
}

}  // namespace throng
