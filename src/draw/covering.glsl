// Masks out the samples that a fragment does not cover. Include it only in fragment shaders that need it: a shader that
// may write gl_SampleMask gets no early depth test.
#include "gpu/shader_types.h"
#include "draw/coverage.glsl"

CONSTANT(2, uint, kSamples, 4);  // of a pixel

layout(location = 5) flat in uint in_layer;

// `pixel`: on a grid that stays fixed from frame to frame.
void cover(float alpha, uvec2 pixel) {
    uint samples = 0;
    for (uint i = 0; i < kSamples; ++i)
        samples |= (covers(alpha, pixel.x, pixel.y, i, kSamples, in_layer) ? 1u : 0u) << i;
    if (samples == 0) discard;
    gl_SampleMask[0] = int(samples);
}
