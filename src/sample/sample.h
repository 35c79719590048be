// The sample stage: one clip of each instance -> the pose of its joints.
#pragma once

#include "sample/sample_io.h"
#include "gpu/kernel.h"

namespace throng {

// Dispatched with io::SamplePush, a workgroup per instance.
// `packed`: Character::packed. `varies`: instances come and go, and those that are not there are left out.
Kernel sample_kernel(const std::shared_ptr<Gpu>& gpu, bool packed, bool varies = false);

}  // namespace throng
