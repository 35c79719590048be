// A blend space of two parameters: which clips surround which place.
#pragma once

#include "control/controller_io.h"

#include <throng/controller.h>

#include <span>
#include <vector>

namespace throng {

struct BlendSpace {
    // They fill the hull of the points and do not overlap; none if the points lie on a line
    std::vector<io::ControlTriangle> triangles;
    // The border of the triangles; without triangles, those along the line; for a single point, one from it to itself
    std::vector<io::ControlEdge> edges;
};

// The Delaunay triangulation of the points (at least one, all at different places). x and y may have different units,
// so both are scaled to the same range first. Triangles at the border that are flatter than 1e-4 of their length are
// left out, since floats could not tell places within them apart. Each edge flip searches all pairs of triangles, which
// is quick enough for the 64 points that a state can have.
BlendSpace make_blend_space(std::span<const BlendPoint> points);

}  // namespace throng
