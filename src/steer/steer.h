// The steer stage: placements and destinations -> a step on the way, out of the way of others; or a turn, and the speed
// that the clips are to carry the character at.
#pragma once

#include "gpu/kernel.h"
#include "steer/steer_io.h"

#include <cstdint>
#include <span>
#include <vector>

namespace throng {

// Dispatched one after the other, with a barrier between, an invocation per instance: places with io::PlacesPush for
// all agents of the crowd, then steer with io::SteerPush.
struct SteerKernels {
    explicit SteerKernels(const std::shared_ptr<Gpu>& gpu);

    Kernel places, steer;
};

// Agents of about one size are in a grid of their own, so that a few large ones do not crowd the cells of the others.
struct AgentGrid {
    float largest = 0;       // radius of its agents
    float inverse_cell = 0;  // 1 / the width of a cell; nine cells hold all of these that one of them can meet
};
// The grids, the largest agents first, at most kAgentGridLimit. `radii`: of all agents.
std::vector<AgentGrid> agent_grids(std::vector<float> radii);
// The grid of the agents of this radius, which must be one of those that the grids were made from.
uint32_t grid_of(std::span<const AgentGrid> grids, float radius);

}  // namespace throng
