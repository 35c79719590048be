#include "sample/sample.h"

namespace throng {
namespace {

constexpr uint32_t kPlain[] = {
#include "sample/sample.comp.inc"
};
constexpr uint32_t kWide[] = {
#include "sample/sample.wide.inc"
};

}  // namespace

Kernel sample_kernel(const std::shared_ptr<Gpu>& gpu, bool packed) {
    return Kernel(gpu, {.name = "sample",
                        .spirv = gpu->prefers_wide_words() ? std::span<const uint32_t>(kWide) : kPlain,
                        .constants = {packed ? 1u : 0u}});
}

}  // namespace throng
