// The definition of the steer stage (docs/steering.md), in double precision: tests each agent against every other one,
// without a grid.
#pragma once

#include <throng/steering.h>

#include <optional>
#include <span>
#include <vector>

namespace throng {

struct SteeredAgent {
    Steering steering;
    bool is_carried = false;  // by the root motion of its clips: it only turns
    AffineT<double> world_from_model;
    std::optional<Vec3<double>> destination;
    double speed = 0;  // chosen in the last update, world units a second
    double patience = 1;
    bool stands = false;

    // The speed that the controller gets, in model units a second.
    double model_speed() const;
};

// All agents after an update. time_step_s > 0.
std::vector<SteeredAgent> steer_reference(std::span<const SteeredAgent> agents, double time_step_s);

}  // namespace throng
