// How skin matrices move to a pose that is animated ahead of time: the definition of the update_rate stage, in double
// precision.
#pragma once

#include <throng/transform.h>

#include <cstdint>

namespace throng {

// Moves a matrix that is to arrive in `step` updates by 1 / step of the remaining way, linearly; with 1 it arrives. In
// crowds of similarities rotations are normalised on the shortest path instead, a difference that nobody sees in so
// small a character.
AffineT<double> update_rate_reference(const AffineT<double>& previous, const AffineT<double>& target, uint32_t step);

// An instance of this size on the screen, in pixels, is animated in one of this many updates.
uint32_t period_reference(double size_pixels, double full_rate_pixels);

}  // namespace throng
