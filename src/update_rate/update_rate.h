// The update_rate stage: skin matrices of instances in updates in which they are not animated.
#pragma once

#include "gpu/kernel.h"
#include "update_rate/update_rate_io.h"

#include <throng/skin_format.h>

namespace throng {

// Dispatched with io::UpdateRatePush, a workgroup for each instance of the section.
Kernel update_rate_kernel(const std::shared_ptr<Gpu>& gpu, SkinFormat format);

}  // namespace throng
