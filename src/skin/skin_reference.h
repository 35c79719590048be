// The definition of the skin stage.
#pragma once

#include "morph/morph_reference.h"

#include <throng/character.h>
#include <throng/skin_format.h>

#include <span>

namespace throng {

struct WeightedTransform {
    double weight = 0;
    AffineT<double> transform;
};

// The transform of one vertex: the weighted sum of the matrices; or of dual quaternions and scales, for matrices that
// are a rotation, a uniform scale and a translation.
AffineT<double> blended_transform(SkinBlend blend, std::span<const WeightedTransform> transforms);

// Positions of vertices, with what the active morphs add to them, under the blend of their skin matrices; in the order
// of Character::vertices, model space.
std::vector<Vec3<double>> skin_reference(const Character& character, std::span<const AffineT<double>> model_from_bind,
                                         std::span<const WeightedMorph> morphs = {},
                                         SkinBlend blend = SkinBlend::kLinear);

}  // namespace throng
