// The steer stage: placements and destinations -> a step on the way, out of the way of others; or a turn, and the speed
// that the clips are to carry the character at.
#pragma once

#include "gpu/kernel.h"
#include "steer/steer_io.h"

namespace throng {

// Each in the order of the bindings.
struct PlacesBuffers {
    BufferRange placements;  // Affine[instance_count], world_from_model
    BufferRange places;      // io::AgentPlace[agents of the crowd], written
    BufferRange heads;       // uint[buckets], filled with io::kNobody before
};
struct SteerBuffers {
    BufferRange places, heads;  // as above, as tables (gpu/table.glsl)
    BufferRange destinations;   // float4[instance_count], a place of the world and whether there is one
    BufferRange states;         // io::AgentState[instance_count], read and written
    BufferRange placements;     // read and written
    // io::RootState[instance_count], read and written where root motion carries the instances; else any buffer
    BufferRange roots;
    // float[instance_count][parameter_count], one of them written, where it is told the speed; else any buffer
    BufferRange parameters;
};

// Dispatched one after the other, with a barrier between, an invocation per instance: places with io::PlacesPush for
// all agents of the crowd, then steer with io::SteerPush.
struct SteerKernels {
    explicit SteerKernels(const std::shared_ptr<Gpu>& gpu);

    Kernel places, steer;
};

}  // namespace throng
