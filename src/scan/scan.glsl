// The interface of every scan method: a method defines scan(), which reads transforms by load_local() and writes each joint's by
// store_model(), or to model[] where it reads them back. constant_id 0 is the workgroup size, 1 to 7 are the method's own; links[] is its own table of the skeleton, made
// beside it in <method>.cpp. The same file is compiled as several variants:
//   GPU_WIDE          transforms move as 64-bit words, for software devices
//   SCAN_QUATERNION   local transforms are similarities, 32 bytes each, and so are products
//   SCAN_TRANSPOSED   local[joint][instance], model[joint][instance]
//   SCAN_ON_CHIP      the benchmark of a method's cost without memory: local transforms lie in shared memory, the same for every
//                     character, and are scanned repeat after repeat; only the last repeat's results are stored
// A method whose invocations exchange transforms through model[] or scratch[] (same shape) defines SCAN_EXCHANGE as coherent; one
// that exchanges through shared memory defines SCAN_SHARES.
#extension GL_KHR_memory_scope_semantics : require
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

layout(local_size_x_id = 0) in;
layout(set = 0, binding = 0, std430) readonly buffer Local { StoredTransform local[]; };
layout(set = 0, binding = 1, std430) readonly buffer Links { uint links[]; };
layout(set = 0, binding = 2, std430) SCAN_EXCHANGE buffer Model { StoredAffine model[]; };
layout(set = 0, binding = 3, std430) SCAN_EXCHANGE buffer Scratch { StoredAffine scratch[]; };
layout(push_constant) uniform Push { ScanPush push; };

void scan();

// Everything that the workgroup wrote to shared memory (and `through_buffers`, to model and scratch) can be read after it.
void scan_barrier(bool through_buffers);

uint at(uint instance, uint joint) {
#ifdef SCAN_TRANSPOSED
    return joint * push.instance_count + instance;
#else
    return instance * push.joint_count + joint;
#endif
}

#ifndef SCAN_ON_CHIP

Transform load_local(uint instance, uint joint) { return unpack(local[at(instance, joint)]); }
void store_model(uint instance, uint joint, Transform model_from_joint) { model[at(instance, joint)] = pack(to_affine(model_from_joint)); }

void scan_barrier(bool through_buffers) {
    if (through_buffers)
        controlBarrier(gl_ScopeWorkgroup, gl_ScopeWorkgroup, gl_StorageSemanticsBuffer | gl_StorageSemanticsShared, gl_SemanticsAcquireRelease);
    else barrier();
}

void main() { scan(); }

#else

layout(constant_id = 8) const bool kBarriersTwice = false;  // to measure what barriers cost
layout(constant_id = 9) const uint kOnChipCharacters = 1;  // of a workgroup
layout(constant_id = 10) const uint kOnChipTransforms = 1;  // of all of them
shared StoredTransform on_chip_locals[kOnChipTransforms];   // [character][joint]
shared uint on_chip_between_barriers;                       // so that two of them are not merged into one
uint on_chip_repeat;   // counts down to 0
vec4 on_chip_sink = vec4(0);

// The repeat moves each joint a little, so that no repeat's work can be reused by the next.
Transform load_local(uint instance, uint joint) {
    Transform parent_from_joint = unpack(on_chip_locals[instance % kOnChipCharacters * push.joint_count + joint]);
#ifdef SCAN_QUATERNION
    parent_from_joint.translation_scale.x += float(on_chip_repeat);
#else
    parent_from_joint.row0.w += float(on_chip_repeat);
#endif
    return parent_from_joint;
}

void store_model(uint instance, uint joint, Transform model_from_joint) {
    const Affine m = to_affine(model_from_joint);
    if (on_chip_repeat == 0) model[at(instance, joint)] = pack(m);
    else on_chip_sink += m.row0 + m.row1 + m.row2;
}

void scan_barrier(bool through_buffers) {
    barrier();
    if (!kBarriersTwice) return;
    if (gl_LocalInvocationID.x == 0) on_chip_between_barriers = on_chip_repeat;
    barrier();
}

void main() {
    for (uint i = gl_LocalInvocationID.x; i < kOnChipTransforms; i += gl_WorkGroupSize.x) on_chip_locals[i] = local[i % push.joint_count];
    barrier();
    for (on_chip_repeat = push.repeat_count; on_chip_repeat-- > 0;) {
        scan();
#ifdef SCAN_SHARES
        barrier();  // the next repeat overwrites what this one shares
#endif
    }
    // Never true, which the compiler cannot know: without it what the repeats write would be unused.
    if (on_chip_sink.x == 0.12345 || on_chip_between_barriers == 0x12345678) scratch[0] = pack(Affine(on_chip_sink, on_chip_sink, on_chip_sink));
}

#endif
