// Arithmetic on lanes, for any instruction set. Include a native/lanes_*.h, which defines Lanes, first.
#pragma once

#include <cstdint>

#define INLINE [[gnu::always_inline]] inline

namespace {

using V = Lanes::V;
using I = Lanes::I;

struct Quad {
    V x, y, z, w;
};
INLINE Quad operator+(const Quad& a, const Quad& b) { return {a.x + b.x, a.y + b.y, a.z + b.z, a.w + b.w}; }
INLINE Quad operator-(const Quad& a, const Quad& b) { return {a.x - b.x, a.y - b.y, a.z - b.z, a.w - b.w}; }
INLINE Quad operator*(const Quad& a, V s) { return {a.x * s, a.y * s, a.z * s, a.w * s}; }
INLINE V dot(const Quad& a, const Quad& b) { return a.x * b.x + a.y * b.y + (a.z * b.z + a.w * b.w); }
INLINE V mix(V a, V b, V part) { return a + part * (b - a); }
INLINE Quad mix(const Quad& a, const Quad& b, V part) {
    return {mix(a.x, b.x, part), mix(a.y, b.y, part), mix(a.z, b.z, part), mix(a.w, b.w, part)};
}

// Three rows of four, of as many matrices as there are lanes.
struct Matrix {
    V of[3][4];
};

INLINE void store(float* to, const Matrix& m) {
    for (uint32_t i = 0; i < 12; ++i) Lanes::store(to + i * Lanes::kCount, m.of[i / 4][i % 4]);
}
INLINE Matrix load_matrix(const float* from) {
    Matrix m;
    for (uint32_t i = 0; i < 12; ++i) m.of[i / 4][i % 4] = Lanes::load(from + i * Lanes::kCount);
    return m;
}

// a * b: first b, then a; gpu/affine.glsl without its additions of 0.
INLINE Matrix product(const Matrix& a, const Matrix& b) {
    Matrix m;
    for (uint32_t r = 0; r < 3; ++r) {
        const V x = a.of[r][0], y = a.of[r][1], z = a.of[r][2];
        for (uint32_t c = 0; c < 3; ++c) m.of[r][c] = x * b.of[0][c] + y * b.of[1][c] + z * b.of[2][c];
        m.of[r][3] = x * b.of[0][3] + y * b.of[1][3] + z * b.of[2][3] + a.of[r][3];
    }
    return m;
}
INLINE Matrix splat(const float* affine) {
    Matrix m;
    for (uint32_t i = 0; i < 12; ++i) m.of[i / 4][i % 4] = Lanes::set(affine[i]);
    return m;
}

// The matrix that rotates by a quaternion of any length about `pivot`, with scaled columns, and moves the pivot to
// `centre`.
INLINE Matrix matrix_of(const Quad& q, const V (&scale)[3], const V (&centre)[3], const float* pivot, bool uniform) {
    const V twice = Lanes::set(2) * Lanes::inverse(dot(q, q));
    Matrix m;
    if (uniform) {
        const V s = scale[0] * twice;
        const V xs = q.x * s, ys = q.y * s, zs = q.z * s;
        const V xx = q.x * xs, yy = q.y * ys, zz = q.z * zs, xy = q.x * ys, xz = q.x * zs, yz = q.y * zs;
        m.of[0][0] = scale[0] - (yy + zz);
        m.of[0][1] = xy - q.w * zs;
        m.of[0][2] = xz + q.w * ys;
        m.of[1][0] = xy + q.w * zs;
        m.of[1][1] = scale[0] - (xx + zz);
        m.of[1][2] = yz - q.w * xs;
        m.of[2][0] = xz - q.w * ys;
        m.of[2][1] = yz + q.w * xs;
        m.of[2][2] = scale[0] - (xx + yy);
    } else {
        const V one = Lanes::set(1);
        const V xs = q.x * twice, ys = q.y * twice, zs = q.z * twice;
        const V xx = q.x * xs, yy = q.y * ys, zz = q.z * zs, xy = q.x * ys, xz = q.x * zs, yz = q.y * zs;
        m.of[0][0] = (one - (yy + zz)) * scale[0];
        m.of[0][1] = (xy - q.w * zs) * scale[1];
        m.of[0][2] = (xz + q.w * ys) * scale[2];
        m.of[1][0] = (xy + q.w * zs) * scale[0];
        m.of[1][1] = (one - (xx + zz)) * scale[1];
        m.of[1][2] = (yz - q.w * xs) * scale[2];
        m.of[2][0] = (xz - q.w * ys) * scale[0];
        m.of[2][1] = (yz + q.w * xs) * scale[1];
        m.of[2][2] = (one - (xx + yy)) * scale[2];
    }
    for (uint32_t r = 0; r < 3; ++r)
        m.of[r][3] = centre[r] - m.of[r][0] * Lanes::set(pivot[0]) - m.of[r][1] * Lanes::set(pivot[1]) -
                     m.of[r][2] * Lanes::set(pivot[2]);
    return m;
}

}  // namespace
