// A blend space of two parameters: which clips surround which place.
#pragma once

#include "control/controller_io.h"

#include <throng/controller.h>

#include <span>
#include <vector>

namespace throng {

struct BlendSpace {
    // Fill the hull of the points and do not overlap; none where the points lie on a line
    std::vector<io::ControlTriangle> triangles;
    // The border of the triangles; or along the line; or of a single point to itself
    std::vector<io::ControlEdge> edges;
};

// Delaunay's triangulation of the points (different places, at least one); x and y, which have units of their own, are
// scaled to the same range for it. Triangles flatter than 1e-4 of their length at the border are left out: in float
// nothing could be said within them. O(points^2) and quick for the 64 points that a state may have.
BlendSpace make_blend_space(std::span<const BlendPoint> points);

}  // namespace throng
