// Rotation, translation and one scale, in double precision: the spaces that rows are brought into.
#pragma once

#include <throng/transform.h>

#include <optional>

namespace throng::native {

struct Similarity {
    Quaternion<double> rotation{};
    Vec3<double> translation{};
    double scale = 1;
};

Similarity operator*(const Similarity& a, const Similarity& b);
Similarity inverse(const Similarity& s);
AffineT<double> to_affine(const Similarity& s);
Vec3<double> rotated(const Quaternion<double>& q, const Vec3<double>& v);

// The similarity that a matrix nearly is; none where it is far from one.
std::optional<Similarity> similarity_of(const AffineT<double>& m);

}  // namespace throng::native
