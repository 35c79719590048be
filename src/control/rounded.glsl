// Sums and products that are rounded once each, whatever surrounds them: GPUs may otherwise contract them, and CPU and
// GPU would decide differently.
// (`precise` on larger expressions makes glslc 2023.2 run out of memory.)
float sum(float a, float b) {
    precise float rounded = a + b;
    return rounded;
}

float product(float a, float b) {
    precise float rounded = a * b;
    return rounded;
}

float difference(float a, float b) {
    precise float rounded = a - b;
    return rounded;
}
