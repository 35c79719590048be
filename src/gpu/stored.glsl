// Transforms as they lie in memory. A software device pays for each load and store, not for each byte (lavapipe loops
// over the invocations for every scalar): GPU_SOFTWARE moves them as 64-bit words, half as many. Needs shaderInt64.
#ifndef THRONG_GPU_STORED_GLSL
#define THRONG_GPU_STORED_GLSL
#include "gpu/similarity.glsl"

#ifdef GPU_SOFTWARE
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require

struct StoredAffine {
    u64vec2 row0, row1, row2;
};
struct StoredSimilarity {
    u64vec2 rotation, translation_scale;
};
#define StoredPair uint64_t
#define StoredRow u64vec2

vec4 unpack(u64vec2 v) { return uintBitsToFloat(uvec4(unpackUint2x32(v.x), unpackUint2x32(v.y))); }
u64vec2 pack(vec4 v) { return u64vec2(packUint2x32(floatBitsToUint(v.xy)), packUint2x32(floatBitsToUint(v.zw))); }

Affine unpack(StoredAffine m) { return Affine(unpack(m.row0), unpack(m.row1), unpack(m.row2)); }
StoredAffine pack(Affine m) { return StoredAffine(pack(m.row0), pack(m.row1), pack(m.row2)); }
Similarity unpack(StoredSimilarity s) { return Similarity(unpack(s.rotation), unpack(s.translation_scale)); }
StoredSimilarity pack(Similarity s) { return StoredSimilarity(pack(s.rotation), pack(s.translation_scale)); }
uvec2 unpack(StoredPair pair) { return unpackUint2x32(pair); }
StoredPair pack(uvec2 pair) { return packUint2x32(pair); }

#else

#define StoredAffine Affine
#define StoredSimilarity Similarity
#define StoredPair uvec2
#define StoredRow vec4
vec4 unpack(vec4 row) { return row; }
vec4 pack(vec4 row) { return row; }
Affine unpack(Affine m) { return m; }
Affine pack(Affine m) { return m; }
Similarity unpack(Similarity s) { return s; }
Similarity pack(Similarity s) { return s; }
uvec2 unpack(uvec2 pair) { return pair; }
uvec2 pack(uvec2 pair) { return pair; }

#endif
#endif
