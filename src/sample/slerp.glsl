// Spherical interpolation that uses only functions of known precision.
#ifndef THRONG_SLERP_GLSL
#define THRONG_SLERP_GLSL

#include "gpu/angles.glsl"

// Spherical interpolation of unit quaternions in one hemisphere (dot >= 0, which compiled clips guarantee).
// The angle comes from |b - a| / |b + a| = tan(angle / 2), which keeps its digits where the dot product loses them.
vec4 slerp(vec4 a, vec4 b, float w) {
    const vec4 difference = b - a, sum = b + a;
    const float tangent = min(sqrt(dot(difference, difference) / dot(sum, sum)), 1);
    vec4 q;
    if (tangent < 1e-3) {  // below 2 mrad a chord and its arc differ by less than 1e-9
        q = a + difference * w;
    } else {
        const float angle = 2 * atan_unit(tangent);
        q = a * sin_quarter((1 - w) * angle) + b * sin_quarter(w * angle);
    }
    return q * inversesqrt(dot(q, q));
}

#endif
