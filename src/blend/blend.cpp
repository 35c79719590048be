#include "blend/blend.h"

namespace throng {
namespace {

constexpr uint32_t kPlain[] = {
#include "blend/blend.comp.inc"
};
constexpr uint32_t kSoftware[] = {
#include "blend/blend.software.inc"
};

}  // namespace

Kernel blend_kernel(const std::shared_ptr<Gpu>& gpu, const BlendSettings& settings) {
    return Kernel(gpu, {.name = "blend",
                        .spirv = gpu->uses_software_kernels() ? std::span<const uint32_t>(kSoftware) : kPlain,
                        .constants = {settings.output == BlendOutput::kSimilarity, settings.pose_overrides}});
}

}  // namespace throng
