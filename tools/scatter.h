// Puts characters on a field, each with its own clips, time and blend; the same for the same seed everywhere.
#pragma once

#include <throng/crowd.h>

#include <cstdint>
#include <span>
#include <vector>

namespace throng::tools {

struct Scatter {
    std::vector<CrowdGroup> groups;     // instances dealt out evenly to the characters
    std::vector<Playback> playback;     // [instance_count], groups one after the other, as a Crowd numbers them
    std::vector<Affine> placement;
};

// A jittered square grid around the origin, kinds mixed. Where there are several characters, each is scaled to the size of the
// largest, since files come in different units.
Scatter scatter(std::span<const Character> characters, uint32_t count, uint64_t seed);

}  // namespace throng::tools
