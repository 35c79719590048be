#include "control/control.h"

#include "shaders.h"

namespace throng {

Kernel control_kernel(const std::shared_ptr<Gpu>& gpu) {
    return Kernel(gpu, {.name = "control", .spirv = shaders::control.words(*gpu)});
}

}  // namespace throng
