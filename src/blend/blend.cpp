#include "blend/blend.h"

namespace throng {
namespace {

constexpr uint32_t kPlain[] = {
#include "blend/blend.comp.inc"
};
constexpr uint32_t kWide[] = {
#include "blend/blend.wide.inc"
};

}  // namespace

Kernel blend_kernel(const std::shared_ptr<Gpu>& gpu, const BlendSettings& settings) {
    return Kernel(gpu, {.name = "blend",
                        .spirv = gpu->prefers_wide_words() ? std::span<const uint32_t>(kWide) : kPlain,
                        .constants = {settings.output == BlendOutput::kSimilarity, settings.posed}});
}

}  // namespace throng
