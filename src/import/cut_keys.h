// Curves that begin before time 0.
#pragma once

#include <throng/asset.h>

#include <vector>

namespace throng::gltf {

// The keys of a curve, as AssetTrack and AssetMorphTrack have them.
struct CurveKeys {
    Interpolation interpolation;
    bool is_rotation;
    std::vector<float>& times_s;
    std::vector<float>& values;
};

// Drops what lies before time 0. The curve's value at 0 becomes its first key; after 0 the curve stays as it is.
void cut_before_zero(const CurveKeys& curve);

}  // namespace throng::gltf
