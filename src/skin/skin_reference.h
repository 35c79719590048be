// The definition of the skin stage.
#pragma once

#include "morph/morph_reference.h"

#include <throng/character.h>
#include <throng/skin_format.h>

#include <span>

namespace throng {

// The transform of one vertex: the weighted sum of the added matrices or, for matrices that consist of a rotation, a
// uniform scale and a translation, of their dual quaternions and scales.
class BlendedTransform {
public:
    explicit BlendedTransform(SkinBlend blend) : blend_(blend) {}
    void add(double weight, const AffineT<double>& transform);
    AffineT<double> result() const;

private:
    void add_dual_quaternion(double weight, const Trs<double>& parts);

    SkinBlend blend_;
    AffineT<double> sum_{.row = {}};
    Quaternion<double> rotation_{0, 0, 0, 0}, dual_{0, 0, 0, 0};
    double scale_ = 0;
};

// model_from_bind of one vertex of a section, counted from the section's first: its influences, blended.
AffineT<double> blended_reference(const Character& character, const MeshSection& section, uint32_t vertex_index,
                                  std::span<const AffineT<double>> model_from_bind,
                                  SkinBlend blend = SkinBlend::kLinear);

// Positions of all vertices in model space, in the order of Character::vertices: morphed by the active morphs, then
// skinned.
std::vector<Vec3<double>> skin_reference(const Character& character, std::span<const AffineT<double>> model_from_bind,
                                         std::span<const WeightedMorph> morphs = {},
                                         SkinBlend blend = SkinBlend::kLinear);

}  // namespace throng
