// Puts characters on a field, each with its own clips, time and blend; the same for the same seed everywhere.
#pragma once

#include "tools/scene/placement.h"

#include <throng/crowd.h>
#include <throng/draw.h>

#include <cstdint>
#include <span>
#include <vector>

namespace throng::tools {

struct ScatterSettings {
    std::vector<uint32_t> counts;  // [characters]: of each
    // [characters], world units. If empty, all are scaled to the size of the largest, since files come in different
    // units, and take the same room
    std::vector<double> heights;
    Formation formation = Formation::kGrid;
    double spacing = 1;  // 1: a character takes a square or circle as wide as its rest pose
    uint64_t seed = 1;
};

struct Scatter {
    std::vector<CrowdGroup> groups;  // one for each character
    std::vector<Playback> playback;  // [instance_count], groups one after the other, as a Crowd numbers them
    std::vector<Affine> placement;
    std::vector<double> scales;  // [characters], how much larger than in their files
};

// How wide a character is on the ground, in its file's units.
double footprint(const Character& character);

// Splits `count` into `parts` parts, as evenly as possible.
std::vector<uint32_t> deal_out(uint32_t count, size_t parts);

// Around the origin, standing on the ground, kinds mixed. Throws CommandError if heights differ too much to be placed
// together.
Scatter scatter(std::span<const Character> characters, const ScatterSettings& settings);

// These bounds, enlarged for each instance without a controller by the bounds of the clips that it plays: some clips
// carry a character far from where it stands. World space.
Bounds reached_bounds(const Bounds& bounds, const Scatter& field);

}  // namespace throng::tools
