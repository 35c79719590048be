#include "steer/steer.h"

#include "shaders.h"

namespace throng {

SteerKernels::SteerKernels(const std::shared_ptr<Gpu>& gpu)
    : places(gpu, {.name = "places", .spirv = shaders::places.words(*gpu)}),
      steer(gpu, {.name = "steer", .spirv = shaders::steer.words(*gpu)}) {}

}  // namespace throng
