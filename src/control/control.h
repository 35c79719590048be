// The control stage: playback state -> time -> rows of keys. And the controller stage: parameters and layers of each
// instance -> the active clips of its pose, events and root motion (docs/controller.md).
#pragma once

#include "control/control_io.h"
#include "control/controller_io.h"
#include "gpu/kernel.h"

namespace throng {

// Dispatched with io::ControlPush, an invocation per instance.
Kernel control_kernel(const std::shared_ptr<Gpu>& gpu);

// Dispatched with io::ControllerPush, an invocation per instance.
Kernel controller_kernel(const std::shared_ptr<Gpu>& gpu);

// Dispatched with io::CommandPush, an invocation per command.
Kernel command_kernel(const std::shared_ptr<Gpu>& gpu);

}  // namespace throng
