// Normals for vertices that have none.
#pragma once

#include <throng/asset.h>

#include <vector>

namespace throng {

// Smooth normals: those of the triangles at each vertex, weighted by area and summed; of length 0 if the sum is.
std::vector<Vec3<float>> smooth_normals(const AssetPrimitive& primitive);

}  // namespace throng
