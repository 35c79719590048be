#include "steer/steer.h"

#include "steer/places.kernel.h"
#include "steer/steer.kernel.h"

namespace throng {

SteerKernels::SteerKernels(const std::shared_ptr<Gpu>& gpu)
    : places(kernels::places.on(gpu)), steer(kernels::steer.on(gpu)) {}

}  // namespace throng
