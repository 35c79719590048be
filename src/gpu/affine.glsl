// 3x4 affine matrices as three rows, so that each is three 16-byte loads. Column vectors, as in throng/transform.h.
// Also compiles as C++ (gpu/glsl.h).
#ifndef THRONG_GPU_AFFINE_GLSL
#define THRONG_GPU_AFFINE_GLSL
#include "gpu/shader_types.h"

struct Affine {
    vec4 row0, row1, row2;
};

const Affine kIdentity = {vec4(1, 0, 0, 0), vec4(0, 1, 0, 0), vec4(0, 0, 1, 0)};

vec4 affine_row(vec4 a, Affine b) { return a.x * b.row0 + a.y * b.row1 + a.z * b.row2 + vec4(0, 0, 0, a.w); }

// a * b: first b, then a.
Affine affine_multiply(Affine a, Affine b) {
    const Affine product = {affine_row(a.row0, b), affine_row(a.row1, b), affine_row(a.row2, b)};
    return product;
}

Affine affine_from_trs(vec4 q, vec3 translation, vec3 scale) {
    const vec3 twice = 2 * q.xyz;
    const Real xx = q.x * twice.x, yy = q.y * twice.y, zz = q.z * twice.z;
    const Real xy = q.x * twice.y, xz = q.x * twice.z, yz = q.y * twice.z;
    const Real wx = q.w * twice.x, wy = q.w * twice.y, wz = q.w * twice.z;
    const Affine m = {vec4((1 - (yy + zz)) * scale.x, (xy - wz) * scale.y, (xz + wy) * scale.z, translation.x),
                      vec4((xy + wz) * scale.x, (1 - (xx + zz)) * scale.y, (yz - wx) * scale.z, translation.y),
                      vec4((xz - wy) * scale.x, (yz + wx) * scale.y, (1 - (xx + yy)) * scale.z, translation.z)};
    return m;
}

vec3 affine_point(Affine m, vec3 p) {
    return vec3(dot(m.row0, vec4(p, 1)), dot(m.row1, vec4(p, 1)), dot(m.row2, vec4(p, 1)));
}

vec3 affine_column(Affine m, uint k) { return vec3(m.row0[k], m.row1[k], m.row2[k]); }

vec3 affine_vector(Affine m, vec3 v) { return vec3(dot(m.row0.xyz, v), dot(m.row1.xyz, v), dot(m.row2.xyz, v)); }

#endif
