#include "cull/cull.h"

namespace throng {
namespace {

constexpr uint32_t kCull[] = {
#include "cull/cull.comp.inc"
};
constexpr uint32_t kWideCull[] = {
#include "cull/cull.wide.inc"
};
constexpr uint32_t kOffsets[] = {
#include "cull/offsets.comp.inc"
};
constexpr uint32_t kList[] = {
#include "cull/list.comp.inc"
};
constexpr uint32_t kReveal[] = {
#include "cull/reveal.comp.inc"
};
constexpr uint32_t kWideReveal[] = {
#include "cull/reveal.wide.inc"
};
constexpr uint32_t kPyramid[] = {
#include "cull/pyramid.comp.inc"
};

}  // namespace

CullKernels::CullKernels(const std::shared_ptr<Gpu>& gpu)
    : cull(gpu, {.name = "cull", .spirv = gpu->prefers_wide_words() ? std::span<const uint32_t>(kWideCull) : kCull}),
      offsets(gpu, {.name = "offsets", .spirv = kOffsets}),
      list(gpu, {.name = "list", .spirv = kList}),
      reveal(gpu,
             {.name = "reveal", .spirv = gpu->prefers_wide_words() ? std::span<const uint32_t>(kWideReveal) : kReveal}),
      pyramid(gpu, {.name = "pyramid", .spirv = kPyramid}) {}

}  // namespace throng
