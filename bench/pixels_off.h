// How far the vertices of an instance are from where they belong, in the picture.
#pragma once

#include <throng/transform.h>
#include <throng/view.h>

#include <span>

namespace throng::bench {

// The largest distance of two corresponding vertices (model space), in pixels of the view; infinite if any number is
// NaN, or the counts differ.
double pixels_off(std::span<const Vec3<float>> got, std::span<const Vec3<double>> wanted,
                  const Affine& world_from_model, const CrowdView& view);

}  // namespace throng::bench
