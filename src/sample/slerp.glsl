// Spherical interpolation, of functions whose precision is known.
#ifndef THRONG_SLERP_GLSL
#define THRONG_SLERP_GLSL

// atan(r) for 0 <= r <= 1. Source: Abramowitz and Stegun, Handbook of Mathematical Functions, 1964, 4.4.49; error 2e-8.
// Vulkan promises too little of its own atan, sin and cos for poses that must hold to 2e-5 of the character's size.
float atan_unit(float r) {
    const float s = r * r;
    float p = 0.0028662257;
    p = p * s - 0.0161657367;
    p = p * s + 0.0429096138;
    p = p * s - 0.0752896400;
    p = p * s + 0.1065626393;
    p = p * s - 0.1420889944;
    p = p * s + 0.1999355085;
    p = p * s - 0.3333314528;
    return r + r * s * p;
}

// sin(x) for 0 <= x <= pi/2. Source: the same, 4.3.97; error 2e-9.
float sin_quarter(float x) {
    const float s = x * x;
    float p = -0.0000000239;
    p = p * s + 0.0000027526;
    p = p * s - 0.0001984090;
    p = p * s + 0.0083333315;
    p = p * s - 0.1666666664;
    return x + x * s * p;
}

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
