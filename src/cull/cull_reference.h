// What a view sees: the definition of the cull stage, in double precision.
#pragma once

#include "cull/cull_io.h"

#include <throng/transform.h>

namespace throng {

// A character's box in model space, and its levels of detail.
struct CullBox {
    Vec3<double> centre, half_extent;
};

// The way that the box's shadow takes: as far as the view says, but from its highest point no farther than down to the
// ground.
Vec3<double> shadow_of(const io::CullView& view, const AffineT<double>& world_from_model, const CullBox& box);

// The least of all planes' distances, in units of the plane's normal, by which the box with the way of its shadow
// reaches inside: seen where that is not negative.
double seen_by(const io::CullView& view, const AffineT<double>& world_from_model, const CullBox& box);

// By how much a level's error stays below what the view sees, in world space: it is fine enough where that is not
// negative.
double spare_of_lod(const io::CullView& view, const AffineT<double>& world_from_model, const CullBox& box,
                    double lod_error);

}  // namespace throng
