#include "control/control.h"

#include "control/commands.kernel.h"
#include "control/control.kernel.h"
#include "control/controller.kernel.h"

namespace throng {

Kernel control_kernel(const std::shared_ptr<Gpu>& gpu) { return kernels::control.on(gpu); }
Kernel controller_kernel(const std::shared_ptr<Gpu>& gpu) { return kernels::controller.on(gpu); }
Kernel command_kernel(const std::shared_ptr<Gpu>& gpu) { return kernels::commands.on(gpu); }

}  // namespace throng
