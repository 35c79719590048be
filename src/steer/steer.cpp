#include "steer/steer.h"

#include "steer/places.kernel.h"
#include "steer/steer.kernel.h"

#include <algorithm>
#include <functional>

namespace throng {

SteerKernels::SteerKernels(const std::shared_ptr<Gpu>& gpu)
    : places(kernels::places.on(gpu)), steer(kernels::steer.on(gpu)) {}

std::vector<AgentGrid> agent_grids(std::vector<float> radii) {
    constexpr float kReach = 2;  // the same as in steer.glsl
    std::ranges::sort(radii, std::greater());
    std::vector<AgentGrid> grids;
    for (const float radius : radii)
        if (grids.empty() || (radius <= grids.back().largest / 2 && grids.size() < io::kAgentGridLimit))
            grids.push_back({radius, 1 / (2 * kReach * radius)});
    return grids;
}

uint32_t grid_of(std::span<const AgentGrid> grids, float radius) {
    const auto smaller = std::ranges::find_if(grids, [&](const AgentGrid& grid) { return grid.largest < radius; });
    return static_cast<uint32_t>(smaller - grids.begin()) - 1;
}

}  // namespace throng
