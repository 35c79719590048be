// Chooses looks for the instances of a group so that no two neighbours look alike.
#pragma once

#include <throng/throng.h>

#include <functional>
#include <span>
#include <vector>

namespace throng::tools {

// Draws several looks for each instance, and takes the one that differs most from those that its neighbours already
// have (the best-candidate rule of Mitchell, "Spectrally optimal sampling for distribution ray tracing", 1991). Two
// looks differ by the colours of the character's sections, and by which of them are shown. Neighbours are the instances
// that stand within about two places of each other. [world_from_model]
std::vector<InstanceLook> looks_unlike_neighbours(const Character& character, std::span<const Outfit> outfits,
                                                  std::span<const Affine> world_from_model,
                                                  const std::function<InstanceLook()>& draw);

}  // namespace throng::tools
