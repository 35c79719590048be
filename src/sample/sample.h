// The sample stage: one clip of each instance -> the pose of its joints.
#pragma once

#include "sample/sample_io.h"
#include "gpu/kernel.h"

namespace throng {

// Dispatched with io::SamplePush, a workgroup per instance.
// `packed`: Character::packed.
Kernel sample_kernel(const std::shared_ptr<Gpu>& gpu, bool packed);

}  // namespace throng
