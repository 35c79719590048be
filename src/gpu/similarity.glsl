// Rotation, uniform scale and translation: a third fewer bytes than a 3x4 matrix, and closed under products.
#ifndef THRONG_GPU_SIMILARITY_GLSL
#define THRONG_GPU_SIMILARITY_GLSL
#include "gpu/affine.glsl"
#include "gpu/quaternion.glsl"

struct Similarity {
    vec4 rotation;           // unit quaternion x, y, z, w
    vec4 translation_scale;  // translation in xyz, scale in w
};

// a * b: first b, then a.
Similarity similarity_multiply(Similarity a, Similarity b) {
    const vec3 moved = quaternion_rotate(a.rotation, b.translation_scale.xyz);
    return Similarity(
        quaternion_multiply(a.rotation, b.rotation),
        vec4(a.translation_scale.xyz + a.translation_scale.w * moved, a.translation_scale.w * b.translation_scale.w));
}

Affine affine_from_similarity(Similarity s) {
    return affine_from_trs(s.rotation, s.translation_scale.xyz, s.translation_scale.www);
}

// The quaternion of a rotation matrix. Source: S. W. Shepperd, Quaternion from Rotation Matrix, J. Guidance and Control
// 1 (3), 1978: the largest component first, so that no digits are lost.
vec4 quaternion_from_rows(vec3 r0, vec3 r1, vec3 r2) {
    const vec4 squares = 1 + vec4(r0.x - r1.y - r2.z, r1.y - r0.x - r2.z, r2.z - r0.x - r1.y, r0.x + r1.y + r2.z);
    const vec3 sums = vec3(r1.z + r2.y, r0.z + r2.x, r0.y + r1.x),
               differences = vec3(r2.y - r1.z, r0.z - r2.x, r1.x - r0.y);
    vec4 q = vec4(differences, squares.w);
    float largest = squares.w;
    if (squares.x > largest) {
        largest = squares.x;
        q = vec4(squares.x, sums.z, sums.y, differences.x);
    }
    if (squares.y > largest) {
        largest = squares.y;
        q = vec4(sums.z, squares.y, sums.x, differences.y);
    }
    if (squares.z > largest) q = vec4(sums.y, sums.x, squares.z, differences.z);
    return q * inversesqrt(dot(q, q));
}

// `m`: its linear part is a rotation times one factor, which may be negative.
Similarity similarity_from_affine(Affine m) {
    const float size = sqrt(dot(m.row0.xyz, m.row0.xyz));
    const float scale = dot(m.row0.xyz, cross(m.row1.xyz, m.row2.xyz)) < 0 ? -size : size;
    const float inverse = scale != 0 ? 1 / scale : 0;
    return Similarity(quaternion_from_rows(m.row0.xyz * inverse, m.row1.xyz * inverse, m.row2.xyz * inverse),
                      vec4(m.row0.w, m.row1.w, m.row2.w, scale));
}

#endif
