// Chooses looks for the instances of a group so that no two neighbours look alike.
#pragma once

#include <throng/throng.h>

#include <functional>
#include <span>
#include <vector>

namespace throng::tools {

// Calls draw() for several looks of each instance, and takes the one that differs most from those that its neighbours
// already have (the best-candidate rule of Mitchell, "Spectrally optimal sampling for distribution ray tracing", 1991).
// Looks differ by the colours and materials of sections, and by which are shown, weighted by the sections' surfaces.
// Neighbours are all that stand within two places of each other, and some within four. [world_from_model]
std::vector<InstanceLook> looks_unlike_neighbours(const Character& character, std::span<const Outfit> outfits,
                                                  std::span<const Affine> world_from_model,
                                                  const std::function<InstanceLook()>& draw);

}  // namespace throng::tools
