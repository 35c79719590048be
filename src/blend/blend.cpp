#include "blend/blend.h"

#include "blend/blend.kernel.h"

namespace throng {

Kernel blend_kernel(const std::shared_ptr<Gpu>& gpu, const BlendSettings& settings) {
    return kernels::blend.on(gpu,
                             {settings.output == BlendOutput::kSimilarity, settings.pose_overrides, settings.varies});
}

}  // namespace throng
