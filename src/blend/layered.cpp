#include "blend/layered.h"

namespace throng {
namespace {

constexpr uint32_t kPlain[] = {
#include "blend/layered.comp.inc"
};
constexpr uint32_t kWide[] = {
#include "blend/layered.wide.inc"
};

static_assert(sizeof(io::Voice) == 32, "two rows of a table");

}  // namespace

Kernel layered_kernel(const std::shared_ptr<Gpu>& gpu, const LayeredSettings& settings) {
    return Kernel(gpu, {.name = "layered",
                        .spirv = gpu->prefers_wide_words() ? std::span<const uint32_t>(kWide) : kPlain,
                        .constants = {settings.packed, settings.output == BlendOutput::kSimilarity, settings.inertial, settings.posed}});
}

}  // namespace throng
