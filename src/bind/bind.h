// The bind stage: model transforms -> skin matrices.
#pragma once

#include "bind/bind_io.h"
#include "gpu/kernel.h"

#include <throng/skin_format.h>

namespace throng {

// Dispatched with io::BindPush, a workgroup per instance.
// `varies`: instances come and go, and those that are not there are left out.
Kernel bind_kernel(const std::shared_ptr<Gpu>& gpu, SkinFormat format, bool varies = false);

}  // namespace throng
