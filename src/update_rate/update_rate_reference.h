// The way of skin matrices to a pose that is animated ahead of time: the definition of the update_rate stage, in double
// precision.
#pragma once

#include <throng/transform.h>

#include <cstdint>

namespace throng {

// A matrix `step` updates before it is to arrive: the same part of what is left in each update, 1 / step; of 1, it
// arrives. Linearly; in crowds of similarities rotations are normalised on the shortest path, which differs from it by
// what nobody sees in so small a character.
AffineT<double> update_rate_reference(const AffineT<double>& previous, const AffineT<double>& target, uint32_t step);

// An instance of such a size on the screen, in pixels, is animated in one of so many updates.
uint32_t period_reference(double size_pixels, double full_rate_pixels);

}  // namespace throng
