// How far skin matrices are from what they should be.
#pragma once

#include <throng/transform.h>

#include <span>

namespace throng::bench {

// Far above float rounding at 120 levels, far below any mistake.
inline constexpr double kSkinErrorBound = 1e-4;

// The largest difference of any element, as a fraction of the character's size: translations divided by it, the other
// columns as displacements of a point one size away. Infinite where a number is not one, or the counts differ.
double skin_error(std::span<const Affine> got, std::span<const AffineT<double>> wanted, double size);

}  // namespace throng::bench
