#include "bench/pixels_off.h"

#include <algorithm>
#include <limits>

namespace throng::bench {

double pixels_off(std::span<const Vec3<float>> got, std::span<const Vec3<double>> wanted,
                  const Affine& world_from_model, const CrowdView& view) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    if (got.size() != wanted.size()) return kInfinity;
    const AffineT<double> placement = world_from_model.as<double>();
    double most = 0;
    for (size_t vertex = 0; vertex < wanted.size(); ++vertex) {
        const Vec3<double> there = transform_point(placement, got[vertex].as<double>()),
                           place = transform_point(placement, wanted[vertex]);
        const double pixels = length(there - place) * double{view.pixels} / length(place - view.eye.as<double>());
        if (!(pixels >= 0)) return kInfinity;
        most = std::max(most, pixels);
    }
    return most;
}

}  // namespace throng::bench
