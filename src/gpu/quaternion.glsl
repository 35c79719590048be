// Quaternions x, y, z, w. Also compiles as C++ (gpu/glsl.h).
#ifndef THRONG_GPU_QUATERNION_GLSL
#define THRONG_GPU_QUATERNION_GLSL
#include "gpu/shader_types.h"

vec4 quaternion_multiply(vec4 a, vec4 b) {
    return vec4(a.w * b.xyz + b.w * a.xyz + cross(a.xyz, b.xyz), a.w * b.w - dot(a.xyz, b.xyz));
}

vec3 quaternion_rotate(vec4 q, vec3 v) {
    const vec3 t = 2 * cross(q.xyz, v);
    return v + q.w * t + cross(q.xyz, t);
}

#endif
