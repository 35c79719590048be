// Trigonometric functions of known precision: what Vulkan guarantees for its own atan, sin and cos is too little for
// poses that must hold to 2e-5 of the character's size.
#ifndef THRONG_GPU_ANGLES_GLSL
#define THRONG_GPU_ANGLES_GLSL

const float kPi = 3.14159265359, kHalfPi = 1.57079632679;

// atan(r) for 0 <= r <= 1. Source: Abramowitz and Stegun, Handbook of Mathematical Functions, 1964, 4.4.49; error 2e-8.
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

#endif
