// Transforms. Column vectors, right-handed, as in glTF: model_from_joint = model_from_parent * parent_from_joint.
// Templates over the scalar: float is what the GPU sees, double is what the references compute with.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

namespace throng {

template <class T>
struct Vec3 {
    T x = 0, y = 0, z = 0;

    template <class U>
    Vec3<U> as() const {
        return {U(x), U(y), U(z)};
    }
    friend bool operator==(const Vec3&, const Vec3&) = default;
};

// Rotation, x y z w with w the scalar part; unit length unless said otherwise.
template <class T>
struct Quaternion {
    T x = 0, y = 0, z = 0, w = 1;

    template <class U>
    Quaternion<U> as() const {
        return {U(x), U(y), U(z), U(w)};
    }
    friend bool operator==(const Quaternion&, const Quaternion&) = default;
};

// A 3x4 affine matrix, three rows of four: p' = M * (p, 1). 48 bytes as float: the layout of every matrix buffer of
// throng.
template <class T>
struct AffineT {
    std::array<std::array<T, 4>, 3> row{{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};

    template <class U>
    AffineT<U> as() const {
        AffineT<U> out;
        for (std::size_t r = 0; r < 3; ++r)
            for (std::size_t c = 0; c < 4; ++c) out.row[r][c] = U(row[r][c]);
        return out;
    }
    friend bool operator==(const AffineT&, const AffineT&) = default;
};

// Translation * rotation * scale, as a glTF node has it.
template <class T>
struct Trs {
    Quaternion<T> rotation{};
    Vec3<T> translation{};
    Vec3<T> scale{1, 1, 1};

    template <class U>
    Trs<U> as() const {
        return {rotation.template as<U>(), translation.template as<U>(), scale.template as<U>()};
    }
    friend bool operator==(const Trs&, const Trs&) = default;
};

using Affine = AffineT<float>;
static_assert(sizeof(Affine) == 48);

template <class T>
Vec3<T> operator+(const Vec3<T>& a, const Vec3<T>& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class T>
Vec3<T> operator-(const Vec3<T>& a, const Vec3<T>& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class T>
Vec3<T> operator*(const Vec3<T>& a, T s) {
    return {a.x * s, a.y * s, a.z * s};
}
template <class T>
T dot(const Vec3<T>& a, const Vec3<T>& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class T>
Vec3<T> cross(const Vec3<T>& a, const Vec3<T>& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class T>
T length(const Vec3<T>& a) {
    return std::sqrt(dot(a, a));
}
// The zero vector stays zero.
template <class T>
Vec3<T> normalized(const Vec3<T>& a) {
    const T l = length(a);
    return l > T(0) ? a * (T(1) / l) : a;
}
template <class T>
Vec3<T> lerp(const Vec3<T>& a, const Vec3<T>& b, T w) {
    return a * (T(1) - w) + b * w;
}

template <class T>
T dot(const Quaternion<T>& a, const Quaternion<T>& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z + a.w * b.w;
}
template <class T>
Quaternion<T> operator-(const Quaternion<T>& q) {
    return {-q.x, -q.y, -q.z, -q.w};
}
template <class T>
Quaternion<T> operator*(const Quaternion<T>& a, const Quaternion<T>& b) {
    return {a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y, a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
            a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w, a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z};
}
// The zero quaternion becomes the identity.
template <class T>
Quaternion<T> normalized(const Quaternion<T>& q) {
    const T l = std::sqrt(dot(q, q));
    return l > T(0) ? Quaternion<T>{q.x / l, q.y / l, q.z / l, q.w / l} : Quaternion<T>{};
}
template <class T>
Quaternion<T> axis_angle(const Vec3<T>& unit_axis, T angle_rad) {
    const T s = std::sin(angle_rad / 2);
    return {unit_axis.x * s, unit_axis.y * s, unit_axis.z * s, std::cos(angle_rad / 2)};
}

// (a * b) applied to p is a applied to (b applied to p).
template <class T>
AffineT<T> operator*(const AffineT<T>& a, const AffineT<T>& b) {
    AffineT<T> out;
    for (std::size_t r = 0; r < 3; ++r) {
        for (std::size_t c = 0; c < 4; ++c)
            out.row[r][c] = a.row[r][0] * b.row[0][c] + a.row[r][1] * b.row[1][c] + a.row[r][2] * b.row[2][c];
        out.row[r][3] += a.row[r][3];
    }
    return out;
}
template <class T>
Vec3<T> transform_point(const AffineT<T>& m, const Vec3<T>& p) {
    const auto row = [&](std::size_t r) {
        return m.row[r][0] * p.x + m.row[r][1] * p.y + m.row[r][2] * p.z + m.row[r][3];
    };
    return {row(0), row(1), row(2)};
}
template <class T>
Vec3<T> transform_vector(const AffineT<T>& m, const Vec3<T>& v) {
    const auto row = [&](std::size_t r) { return m.row[r][0] * v.x + m.row[r][1] * v.y + m.row[r][2] * v.z; };
    return {row(0), row(1), row(2)};
}
// Determinant of the linear 3x3 part; negative where the matrix mirrors.
template <class T>
T determinant(const AffineT<T>& m) {
    const auto& r = m.row;
    return r[0][0] * (r[1][1] * r[2][2] - r[1][2] * r[2][1]) - r[0][1] * (r[1][0] * r[2][2] - r[1][2] * r[2][0]) +
           r[0][2] * (r[1][0] * r[2][1] - r[1][1] * r[2][0]);
}
template <class T>
AffineT<T> to_affine(const Trs<T>& t) {
    const auto& q = t.rotation;
    const auto& s = t.scale;
    AffineT<T> m;
    m.row[0] = {(1 - 2 * (q.y * q.y + q.z * q.z)) * s.x, 2 * (q.x * q.y - q.z * q.w) * s.y,
                2 * (q.x * q.z + q.y * q.w) * s.z, t.translation.x};
    m.row[1] = {2 * (q.x * q.y + q.z * q.w) * s.x, (1 - 2 * (q.x * q.x + q.z * q.z)) * s.y,
                2 * (q.y * q.z - q.x * q.w) * s.z, t.translation.y};
    m.row[2] = {2 * (q.x * q.z - q.y * q.w) * s.x, 2 * (q.y * q.z + q.x * q.w) * s.y,
                (1 - 2 * (q.x * q.x + q.y * q.y)) * s.z, t.translation.z};
    return m;
}

}  // namespace throng
