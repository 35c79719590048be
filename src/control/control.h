// The control stage: playback state -> time -> rows of keys.
#pragma once

#include "control/control_io.h"
#include "gpu/kernel.h"

namespace throng {

// Dispatched with io::ControlPush, an invocation per instance.
Kernel control_kernel(const std::shared_ptr<Gpu>& gpu);

}  // namespace throng
