// Characters that walk: how large and fast they are, and where they go.
#pragma once

#include <throng/crowd.h>

#include <cstdint>
#include <span>
#include <vector>

namespace throng::tools {

// By its footprint and height, `scale` times as large as in its file. With a controller that has a parameter "speed",
// as fast as the slowest clip that this chooses, and that is what it is told.
Steering steering_of(const Character& character, const Controller* controller, double scale);

// Each one's is the place of another of its group, [placements], by the seed; of a group of one its own.
std::vector<Vec3<float>> each_others_places(std::span<const CrowdGroup> groups, std::span<const Affine> placement,
                                            uint64_t seed);

}  // namespace throng::tools
