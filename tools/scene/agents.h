// Characters that walk: how large and fast they are, and where they go.
#pragma once

#include <throng/crowd.h>

#include <cstdint>
#include <span>
#include <vector>

namespace throng::tools {

// The radius follows from the footprint and the speed from the height, both `scale` times as large as in the file. If
// the controller has a parameter "speed", the speed is that of the slowest clip in its blend spaces, and steering
// sets the parameter.
Steering steering_of(const Character& character, const Controller* controller, double scale);

// Gives each character the place of another one of its group, chosen by the seed; in a group of one, its own.
// [placements]
std::vector<Vec3<float>> each_others_places(std::span<const CrowdGroup> groups, std::span<const Affine> placement,
                                            uint64_t seed);

}  // namespace throng::tools
