#include "cull/cull.h"

#include "shaders.h"

namespace throng {

CullKernels::CullKernels(const std::shared_ptr<Gpu>& gpu)
    : cull(gpu, {.name = "cull", .spirv = shaders::cull.words(*gpu)}),
      offsets(gpu, {.name = "offsets", .spirv = shaders::offsets.words(*gpu)}),
      list(gpu, {.name = "list", .spirv = shaders::list.words(*gpu)}),
      reveal(gpu, {.name = "reveal", .spirv = shaders::reveal.words(*gpu)}),
      pyramid(gpu, {.name = "pyramid", .spirv = shaders::pyramid.words(*gpu)}) {}

}  // namespace throng
