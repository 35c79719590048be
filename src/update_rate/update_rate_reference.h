// The definition of the update_rate stage, in double precision: how skin matrices move to a pose that was computed
// ahead of time.
#pragma once

#include <throng/transform.h>

#include <cstdint>

namespace throng {

// Moves a matrix that is to reach `target` in `step` updates by 1 / step of the remaining way, linearly; with 1 it
// reaches it. Crowds whose skin matrices are similarities interpolate rotations along the shorter arc and normalise
// them instead; such characters are too small on the screen for the difference to be visible.
AffineT<double> update_rate_reference(const AffineT<double>& previous, const AffineT<double>& target, uint32_t step);

// The update period: an instance of this size on the screen is animated in one of this many updates.
uint32_t period_reference(double size_pixels, double full_rate_pixels);

}  // namespace throng
