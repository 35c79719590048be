#include "blend/blend.h"

#include "shaders.h"

namespace throng {

Kernel blend_kernel(const std::shared_ptr<Gpu>& gpu, const BlendSettings& settings) {
    return Kernel(gpu, {.name = "blend",
                        .spirv = shaders::blend.words(*gpu),
                        .constants = {settings.output == BlendOutput::kSimilarity, settings.pose_overrides}});
}

}  // namespace throng
