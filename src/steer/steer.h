// The steer stage: placements and destinations -> a step on the way, out of the way of others; or a turn, and the speed
// that the clips are to carry the character at.
#pragma once

#include "gpu/kernel.h"
#include "steer/steer_io.h"

namespace throng {

// Dispatched one after the other, with a barrier between, an invocation per instance: places with io::PlacesPush for
// all agents of the crowd, then steer with io::SteerPush.
struct SteerKernels {
    explicit SteerKernels(const std::shared_ptr<Gpu>& gpu);

    Kernel places, steer;
};

}  // namespace throng
