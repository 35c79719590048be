// The interface of scan methods. A method defines scan(), for the instances below instance_count(). It reads transforms
// by load_local() and writes each joint's by store_model(), or to model[] if it reads them back. A method that loads
// each joint once calls begin_instance() first, and needs no tile when it is fused. constant_id 0 is the workgroup
// size; 1 to 7 are the method's own. link() reads the method's own table of the skeleton, which <method>.cpp makes.
//
// The same file is compiled as several variants:
//   GPU_SOFTWARE          transforms move as 64-bit words, for software devices
//   SCAN_QUATERNION   local transforms are similarities, 32 bytes each, and so are products
//   SCAN_TRANSPOSED   local[joint][instance], model[joint][instance]
// and with one of these hosts:
//   in_memory.glsl    the stage
//   SCAN_ON_CHIP      scan/on_chip.glsl, the benchmark of a method's cost without memory
//   SCAN_FUSED        fused/fused.glsl, all stages in one pass; in plans that use no model[] and scratch[]
//
// A method whose invocations exchange transforms through model[] or scratch[] (same shape) defines SCAN_EXCHANGE as
// coherent. One that exchanges them through shared memory defines SCAN_SHARES. As C++ (gpu/native_text.h) only the
// stage is compiled, and only for methods without barriers.
#ifndef __cplusplus
#extension GL_KHR_memory_scope_semantics : require
#endif
#include "gpu/stored.glsl"
#include "scan/scan_io.h"

#ifndef SCAN_EXCHANGE
#define SCAN_EXCHANGE
#endif

#ifdef SCAN_QUATERNION
#define Transform Similarity
#define StoredTransform StoredSimilarity
Similarity multiply(Similarity a, Similarity b) { return similarity_multiply(a, b); }
Affine to_affine(Similarity s) { return affine_from_similarity(s); }
const Transform kIdentityTransform = Similarity(vec4(0, 0, 0, 1), vec4(0, 0, 0, 1));
#else
#define Transform Affine
#define StoredTransform StoredAffine
Affine multiply(Affine a, Affine b) { return affine_multiply(a, b); }
Affine to_affine(Affine m) { return m; }
const Transform kIdentityTransform = kIdentity;
#endif

#ifndef __cplusplus
void scan();

// A barrier after which all invocations see what the workgroup wrote to shared memory and, with `through_buffers`, to
// model and scratch.
void scan_barrier(bool through_buffers);
#endif

#if defined(SCAN_FUSED)
#include "fused/fused.glsl"
#elif defined(SCAN_ON_CHIP)
#include "scan/on_chip.glsl"
#else
#include "scan/in_memory.glsl"
#endif
