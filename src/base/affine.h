// Matrices taken apart, in double precision.
#pragma once

#include <throng/transform.h>

#include <optional>

namespace throng {

// None if the matrix is singular, or nearly so.
std::optional<AffineT<double>> inverse(const AffineT<double>& m);

// The translation, rotation and scale nearest to a matrix.
struct Decomposed {
    Trs<double> trs;   // if the matrix mirrors, the scale of x is negative, as in three.js
    double shear = 0;  // what `trs` cannot express: the largest cosine between two axes, 0..1
};
Decomposed decomposed(const AffineT<double>& m);

}  // namespace throng
