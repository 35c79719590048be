#include "cull/cull.h"

namespace throng {
namespace {

constexpr uint32_t kCull[] = {
#include "cull/cull.comp.inc"
};
constexpr uint32_t kSoftwareCull[] = {
#include "cull/cull.software.inc"
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
constexpr uint32_t kSoftwareReveal[] = {
#include "cull/reveal.software.inc"
};
constexpr uint32_t kPyramid[] = {
#include "cull/pyramid.comp.inc"
};

}  // namespace

CullKernels::CullKernels(const std::shared_ptr<Gpu>& gpu)
    : cull(gpu,
           {.name = "cull", .spirv = gpu->uses_software_kernels() ? std::span<const uint32_t>(kSoftwareCull) : kCull}),
      offsets(gpu, {.name = "offsets", .spirv = kOffsets}),
      list(gpu, {.name = "list", .spirv = kList}),
      reveal(gpu, {.name = "reveal",
                   .spirv = gpu->uses_software_kernels() ? std::span<const uint32_t>(kSoftwareReveal) : kReveal}),
      pyramid(gpu, {.name = "pyramid", .spirv = kPyramid}) {}

}  // namespace throng
