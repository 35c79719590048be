// Read-only tables. GPUs, and C++, read them as storage buffers. A software device (GPU_SOFTWARE) reads them as uniform
// texel buffers: lavapipe checks bounds and branches for every lane and word of a storage buffer, but not when it
// gathers texels, which is 10 to 30 times as fast (docs/performance.md). On the host they are made by upload_table().
#ifndef THRONG_GPU_TABLE_GLSL
#define THRONG_GPU_TABLE_GLSL

#ifdef GPU_SOFTWARE
#define TABLE_OF_WORDS(number, name) layout(set = 0, binding = number) uniform usamplerBuffer name
#define TABLE_OF_ROWS(number, name) layout(set = 0, binding = number) uniform usamplerBuffer name
#define WORD_AT(name, index) texelFetch(name, int(index)).x
#define ROW_AT(name, index) texelFetch(name, int(index))
#else
#define TABLE_OF_WORDS(number, name) READONLY_BUFFER(number, uint, name)
#define TABLE_OF_ROWS(number, name) READONLY_BUFFER(number, uvec4, name)
#define WORD_AT(name, index) name[index]
#define ROW_AT(name, index) name[index]
#endif
#define FLOAT_AT(name, index) uintBitsToFloat(WORD_AT(name, index))
#include "gpu/io_words.glsl"

// A matrix of a table, three rows each.
#define AFFINE_AT(name, index)                                                                         \
    Affine(uintBitsToFloat(ROW_AT(name, 3 * (index))), uintBitsToFloat(ROW_AT(name, 3 * (index) + 1)), \
           uintBitsToFloat(ROW_AT(name, 3 * (index) + 2)))

#endif
