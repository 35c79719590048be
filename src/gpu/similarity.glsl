// Rotation, uniform scale and translation: a third fewer bytes than a 3x4 matrix, and closed under products.
#ifndef THRONG_GPU_SIMILARITY_GLSL
#define THRONG_GPU_SIMILARITY_GLSL
#include "gpu/affine.glsl"

struct Similarity {
    vec4 rotation;           // unit quaternion x, y, z, w
    vec4 translation_scale;  // translation in xyz, scale in w
};

vec4 quaternion_multiply(vec4 a, vec4 b) {
    return vec4(a.w * b.xyz + b.w * a.xyz + cross(a.xyz, b.xyz), a.w * b.w - dot(a.xyz, b.xyz));
}

vec3 quaternion_rotate(vec4 q, vec3 v) {
    const vec3 t = 2 * cross(q.xyz, v);
    return v + q.w * t + cross(q.xyz, t);
}

// a * b: first b, then a.
Similarity similarity_multiply(Similarity a, Similarity b) {
    const vec3 moved = quaternion_rotate(a.rotation, b.translation_scale.xyz);
    return Similarity(quaternion_multiply(a.rotation, b.rotation),
                      vec4(a.translation_scale.xyz + a.translation_scale.w * moved, a.translation_scale.w * b.translation_scale.w));
}

Affine affine_from_similarity(Similarity s) {
    return affine_from_trs(s.rotation, s.translation_scale.xyz, s.translation_scale.www);
}

#endif
