// The steer stage: moves each agent a step towards its destination while avoiding others. For agents that are carried
// by their clips: only turns them, and outputs the speed at which the clips should carry them.
#pragma once

#include "gpu/kernel.h"
#include "steer/steer_io.h"

#include <cstdint>
#include <span>
#include <vector>

namespace throng {

// Both are dispatched with an invocation per instance: `places` with io::PlacesPush for all agents of the crowd, then,
// after a barrier, `steer` with io::SteerPush.
struct SteerKernels {
    explicit SteerKernels(const std::shared_ptr<Gpu>& gpu);

    Kernel places, steer;
};

// Agents of similar size share a grid, so that a few large agents do not make the cells of small ones large and
// crowded.
struct AgentGrid {
    float largest = 0;       // largest radius of its agents
    float inverse_cell = 0;  // 1 / cell width; 3 x 3 cells contain all agents of the grid that one of them can meet
};
// At most kAgentGridLimit grids, the one of the largest agents first. `radii`: of all agents.
std::vector<AgentGrid> agent_grids(std::vector<float> radii);
// The index of the grid for agents of this radius, which must be one of the radii given to agent_grids().
uint32_t grid_of(std::span<const AgentGrid> grids, float radius);

}  // namespace throng
