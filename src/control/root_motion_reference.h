// The definition of root motion: how far a clip moves its character over the ground.
#pragma once

#include <array>
#include <cstdint>
#include <span>

namespace throng {

// A turn by yaw about +y, then a shift: (x, z) -> (cos x + sin z + x0, -sin x + cos z + z0).
struct GroundMove {
    double x = 0, z = 0, cos = 1, sin = 0;
};

// a * b: b, then a, as with matrices.
GroundMove operator*(const GroundMove& a, const GroundMove& b);
GroundMove inverse(const GroundMove& a);
GroundMove power(GroundMove a, int64_t exponent);  // by squaring; negative: of the inverse

// Rows x, z, cos, sin of model space, relative to the clip's begin, evenly spaced in phase from 0 to 1 (in units of
// 2^-32). Without rows: no move.
using RootRows = std::span<const std::array<float, 4>>;
GroundMove place_at(RootRows rows, uint32_t phase);

// From one phase to another, over `crossed` ends of the clip between them (negative: backwards), in the model space at
// phase_before.
GroundMove move_between(RootRows rows, uint32_t phase_before, uint32_t phase_after, int64_t crossed);

// Adds to a weighted sum of moves; and returns the sum with its turn normalized (no turn if the turns cancel each
// other).
void add_weighted(GroundMove& sum, const GroundMove& move, double weight);
GroundMove turned_to_length_one(const GroundMove& sum);

}  // namespace throng
