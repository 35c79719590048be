#include "pace/pace.h"

namespace throng {
namespace {

constexpr uint32_t kPace[] = {
#include "pace/pace.comp.inc"
};
constexpr uint32_t kPaceWide[] = {
#include "pace/pace.wide.inc"
};

}  // namespace

Kernel pace_kernel(const std::shared_ptr<Gpu>& gpu, SkinFormat format) {
    return Kernel(gpu, {.name = "pace",
                        .spirv = gpu->prefers_wide_words() ? std::span<const uint32_t>(kPaceWide) : kPace,
                        .constants = {static_cast<uint32_t>(format)}});
}

}  // namespace throng
