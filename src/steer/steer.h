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
    float inverse_cell = 0;  // 1 / the width of a cell, from which nine hold all of these that one of them may meet
};
// The largest first, at most kAgentGridLimit. `radii`: of all agents.
std::vector<AgentGrid> agent_grids(std::vector<float> radii);
// Which of them agents of this radius are in, one of those that they were made of.
uint32_t grid_of(std::span<const AgentGrid> grids, float radius);

}  // namespace throng
