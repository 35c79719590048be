#include "base/affine.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace throng {
namespace {

// From a rotation matrix given by its columns.
// Source: S. W. Shepperd, "Quaternion from Rotation Matrix", Journal of Guidance and Control 1(3), 1978.
Quaternion<double> quaternion_from_axes(const Vec3<double>& x, const Vec3<double>& y, const Vec3<double>& z) {
    const double trace = x.x + y.y + z.z;
    Quaternion<double> q;
    if (trace >= x.x && trace >= y.y && trace >= z.z) {
        q = {y.z - z.y, z.x - x.z, x.y - y.x, 1 + trace};
    } else if (x.x >= y.y && x.x >= z.z) {
        q = {1 + x.x - y.y - z.z, x.y + y.x, z.x + x.z, y.z - z.y};
    } else if (y.y >= z.z) {
        q = {x.y + y.x, 1 - x.x + y.y - z.z, y.z + z.y, z.x - x.z};
    } else {
        q = {z.x + x.z, y.z + z.y, 1 - x.x - y.y + z.z, x.y - y.x};
    }
    return normalized(q);
}

// Replaces axes of zero length by unit vectors orthogonal to the others. Their scale stays zero, but the rotation can
// still be extracted.
void complete_axes(std::array<Vec3<double>, 3>& axes, const std::array<double, 3>& lengths) {
    const auto missing = std::count(lengths.begin(), lengths.end(), 0.0);
    if (missing == 3) axes = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    if (missing == 2) {
        const size_t kept = size_t(std::find_if(lengths.begin(), lengths.end(), [](double l) { return l != 0; }) -
                                   lengths.begin());
        const Vec3<double>& axis = axes[kept];
        const Vec3<double> other = std::abs(axis.x) < 0.5 ? Vec3<double>{1, 0, 0} : Vec3<double>{0, 1, 0};
        axes[(kept + 1) % 3] = normalized(cross(axis, other));
        axes[(kept + 2) % 3] = cross(axis, axes[(kept + 1) % 3]);
    }
    if (missing == 1) {
        const size_t lost = size_t(std::find(lengths.begin(), lengths.end(), 0.0) - lengths.begin());
        axes[lost] = normalized(cross(axes[(lost + 1) % 3], axes[(lost + 2) % 3]));
    }
}

}  // namespace

std::optional<AffineT<double>> inverse(const AffineT<double>& m) {
    const auto cofactor = [&](size_t r, size_t c) {
        const size_t r1 = (r + 1) % 3, r2 = (r + 2) % 3, c1 = (c + 1) % 3, c2 = (c + 2) % 3;
        return m.row[r1][c1] * m.row[r2][c2] - m.row[r1][c2] * m.row[r2][c1];
    };
    const double whole = m.row[0][0] * cofactor(0, 0) + m.row[0][1] * cofactor(0, 1) + m.row[0][2] * cofactor(0, 2);
    double squares = 0;
    for (const auto& row : m.row) squares += row[0] * row[0] + row[1] * row[1] + row[2] * row[2];
    constexpr double kFlat = 1e-6;
    if (!(std::abs(whole) > kFlat * squares * std::sqrt(squares))) return std::nullopt;
    AffineT<double> inverse;
    for (size_t r = 0; r < 3; ++r)
        for (size_t c = 0; c < 3; ++c) inverse.row[r][c] = cofactor(c, r) / whole;
    const Vec3<double> back = transform_vector(inverse, Vec3<double>{m.row[0][3], m.row[1][3], m.row[2][3]});
    inverse.row[0][3] = -back.x;
    inverse.row[1][3] = -back.y;
    inverse.row[2][3] = -back.z;
    return inverse;
}

Decomposed decomposed(const AffineT<double>& m) {
    const auto column = [&](size_t c) { return Vec3<double>{m.row[0][c], m.row[1][c], m.row[2][c]}; };
    std::array<Vec3<double>, 3> axes{column(0), column(1), column(2)};
    std::array<double, 3> lengths{};
    for (size_t i = 0; i < 3; ++i) {
        lengths[i] = length(axes[i]);
        axes[i] = normalized(axes[i]);
    }
    complete_axes(axes, lengths);
    Decomposed out;
    for (size_t i = 0; i < 3; ++i) out.shear = std::max(out.shear, std::abs(dot(axes[i], axes[(i + 1) % 3])));
    if (dot(cross(axes[0], axes[1]), axes[2]) < 0) {
        axes[0] = axes[0] * -1.0;
        lengths[0] = -lengths[0];
    }
    out.trs = {quaternion_from_axes(axes[0], axes[1], axes[2]), column(3), {lengths[0], lengths[1], lengths[2]}};
    return out;
}

}  // namespace throng
