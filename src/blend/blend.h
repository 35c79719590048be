// The blend stage: two poses of each instance -> its local transforms.
#pragma once

#include "blend/blend_io.h"
#include "gpu/kernel.h"

namespace throng {

// Dispatched with io::BlendPush, a workgroup per instance.
// Similarities, 32 bytes each, only for rigs of uniform scale.
enum class BlendOutput { kAffine, kSimilarity };

struct BlendSettings {
    BlendOutput output = BlendOutput::kAffine;
    bool pose_overrides = false;  // the application may set poses
    bool varies = false;          // instances come and go, and those that are not there are left out
};
Kernel blend_kernel(const std::shared_ptr<Gpu>& gpu, const BlendSettings& settings);

}  // namespace throng
