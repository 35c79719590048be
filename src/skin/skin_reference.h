// The definition of the skin stage.
#pragma once

#include "morph/morph_reference.h"

#include <span>

namespace throng {

// Linear blend skinning: sum of weight * skin matrix * position, with what the active morphs add to it, in the order of Character::vertices, model space.
std::vector<Vec3<double>> skin_reference(const Character& character, std::span<const AffineT<double>> model_from_bind, std::span<const WeightedMorph> morphs = {});

}  // namespace throng
