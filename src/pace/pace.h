// The pace stage: skin matrices between two updates of an instance that is not animated in all of them.
#pragma once

#include "gpu/kernel.h"
#include "pace/pace_io.h"

#include <throng/crowd.h>

namespace throng {

// Dispatched with io::PacePush, a workgroup for each instance of the section.
Kernel pace_kernel(const std::shared_ptr<Gpu>& gpu, SkinFormat format);

}  // namespace throng
