// Normals for vertices that have none.
#pragma once

#include <throng/asset.h>

#include <vector>

namespace throng {

// Smooth: of the triangles at each vertex, weighted by their area; of length 0 where these have none.
std::vector<Vec3<float>> smooth_normals(const AssetPrimitive& primitive);

}  // namespace throng
