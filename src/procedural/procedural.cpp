#include "procedural/procedural.h"

namespace throng {
namespace {

constexpr uint32_t kPlain[] = {
#include "procedural/procedural.comp.inc"
};
constexpr uint32_t kWide[] = {
#include "procedural/procedural.wide.inc"
};

}  // namespace

Kernel procedural_kernel(const std::shared_ptr<Gpu>& gpu, uint32_t kind, bool similarities) {
    return Kernel(gpu, {.name = "procedural",
                        .spirv = gpu->prefers_wide_words() ? std::span<const uint32_t>(kWide) : kPlain,
                        .constants = {similarities, kind}});
}

}  // namespace throng
