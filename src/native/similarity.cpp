#include "native/similarity.h"

#include <algorithm>

namespace throng::native {
namespace {

constexpr double kFarOff = 1e-2;  // of the scale, in an element

// Source: S. W. Shepperd, Quaternion from Rotation Matrix, J. Guidance and Control 1 (3), 1978.
Quaternion<double> quaternion_of(const AffineT<double>& m, double scale) {
    const auto r = [&](size_t row, size_t column) { return m.row[row][column] / scale; };
    const std::array<double, 4> squares{1 + r(0, 0) - r(1, 1) - r(2, 2), 1 - r(0, 0) + r(1, 1) - r(2, 2),
                                        1 - r(0, 0) - r(1, 1) + r(2, 2), 1 + r(0, 0) + r(1, 1) + r(2, 2)};
    const Vec3<double> sums{r(2, 1) + r(1, 2), r(0, 2) + r(2, 0), r(1, 0) + r(0, 1)};
    const Vec3<double> differences{r(2, 1) - r(1, 2), r(0, 2) - r(2, 0), r(1, 0) - r(0, 1)};
    const auto largest = std::max_element(squares.begin(), squares.end()) - squares.begin();
    if (largest == 0) return normalized(Quaternion<double>{squares[0], sums.z, sums.y, differences.x});
    if (largest == 1) return normalized(Quaternion<double>{sums.z, squares[1], sums.x, differences.y});
    if (largest == 2) return normalized(Quaternion<double>{sums.y, sums.x, squares[2], differences.z});
    return normalized(Quaternion<double>{differences.x, differences.y, differences.z, squares[3]});
}

}  // namespace

Vec3<double> rotated(const Quaternion<double>& q, const Vec3<double>& v) {
    const Vec3<double> axis{q.x, q.y, q.z}, t = cross(axis, v) * 2.0;
    return v + t * q.w + cross(axis, t);
}

Similarity operator*(const Similarity& a, const Similarity& b) {
    return {a.rotation * b.rotation, rotated(a.rotation, b.translation) * a.scale + a.translation, a.scale * b.scale};
}

Similarity inverse(const Similarity& s) {
    const Quaternion<double> back{-s.rotation.x, -s.rotation.y, -s.rotation.z, s.rotation.w};
    return {back, rotated(back, s.translation) * (-1 / s.scale), 1 / s.scale};
}

AffineT<double> to_affine(const Similarity& s) {
    return throng::to_affine(Trs<double>{s.rotation, s.translation, {s.scale, s.scale, s.scale}});
}

std::optional<Similarity> similarity_of(const AffineT<double>& m) {
    const double scale = std::cbrt(determinant(m));
    if (!std::isfinite(scale) || std::abs(scale) < 1e-12) return std::nullopt;
    const Similarity s{quaternion_of(m, scale), {m.row[0][3], m.row[1][3], m.row[2][3]}, scale};
    const AffineT<double> nearest = to_affine(s);
    for (size_t r = 0; r < 3; ++r)
        for (size_t c = 0; c < 3; ++c)
            if (!(std::abs(nearest.row[r][c] - m.row[r][c]) <= kFarOff * std::abs(scale))) return std::nullopt;
    return s;
}

}  // namespace throng::native
