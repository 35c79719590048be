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

// Drops what lies before time 0: the curve's value there becomes its first key, and from 0 on it stays as it was.
void cut_before_zero(const CurveKeys& curve);

}  // namespace throng::gltf
