// What a view sees: the definition of the cull stage, in double precision.
#pragma once

#include "cull/cull_io.h"

#include <throng/transform.h>

namespace throng {

// A character's box in model space.
struct CullBox {
    Vec3<double> centre, half_extent;
};

// The path of the box's shadow: as far as the view says, but from the box's highest point no farther than the ground.
Vec3<double> shadow_of(const io::CullView& view, const AffineT<double>& world_from_model, const CullBox& box);

// How far the box and its shadow's path reach inside, in units of the plane's normal: the least over all planes, except
// those infinitely far away. The box is seen if it is not negative.
double seen_by(const io::CullView& view, const AffineT<double>& world_from_model, const CullBox& box);

// By how much a level's error stays below what the view sees, in world space: the level is fine enough if that is not
// negative.
double spare_of_lod(const io::CullView& view, const AffineT<double>& world_from_model, const CullBox& box,
                    double lod_error);

}  // namespace throng
