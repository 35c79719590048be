#include "blend/blend.h"

namespace throng {
namespace {

constexpr uint32_t kSpirv[] = {
#include "blend/blend.comp.inc"
};

}  // namespace

Kernel blend_kernel(const std::shared_ptr<Gpu>& gpu, BlendOutput output) {
    return Kernel(gpu, {.name = "blend", .spirv = kSpirv, .constants = {output == BlendOutput::kSimilarity ? 1u : 0u}});
}

}  // namespace throng
