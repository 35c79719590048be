// Which box a ray meets first.
#pragma once

#include "tools/view/orbit.h"

#include <optional>

namespace throng::view {

// A box of a model where it stands in the world.
struct PlacedBox {
    Vec3<float> min, max;  // model space
    Affine world_from_model;
};

// How far along the ray it enters the box, in lengths of the ray's direction: 0 if it begins inside. None if it misses
// the box, or if the placement cannot be inverted.
std::optional<float> distance_to(const PlacedBox& box, const Projection::Ray& ray);

}  // namespace throng::view
