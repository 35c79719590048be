// Host for benchmarking a method without memory traffic: local transforms are in shared memory, the same for every
// character, and are scanned repeatedly; only the last repeat's results are stored.
#include "scan/scan_buffers.glsl"

uint instance_count() { return push.instance_count; }
void begin_instance(uint index) {}

CONSTANT(8, bool, kBarriersTwice, false);                  // to measure what barriers cost
CONSTANT(9, uint, kOnChipCharacters, 1);                   // characters of a workgroup
CONSTANT(10, uint, kOnChipTransforms, 1);                  // local transforms of all of them
shared StoredTransform on_chip_locals[kOnChipTransforms];  // [character][joint]
shared uint on_chip_between_barriers;                      // written between two barriers, so that they are not merged
uint on_chip_repeat;                                       // counts down to 0
vec4 on_chip_sink = vec4(0);

// Each repeat shifts the joints a little, so that the compiler cannot reuse work of the one before.
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
    if (on_chip_repeat == 0)
        model[at(instance, joint)] = pack(m);
    else
        on_chip_sink += m.row0 + m.row1 + m.row2;
}

void scan_barrier(bool through_buffers) {
    barrier();
    if (!kBarriersTwice) return;
    if (gl_LocalInvocationID.x == 0) on_chip_between_barriers = on_chip_repeat;
    barrier();
}

void main() {
    for (uint i = gl_LocalInvocationID.x; i < kOnChipTransforms; i += gl_WorkGroupSize.x)
        on_chip_locals[i] = local[i % push.joint_count];
    barrier();
    for (on_chip_repeat = push.repeat_count; on_chip_repeat-- > 0;) {
        scan();
#ifdef SCAN_SHARES
        barrier();  // the next repeat overwrites what this one shares
#endif
    }
    // Never true, but the compiler cannot know that; without it the repeats' results would be unused.
    if (on_chip_sink.x == 0.12345 || on_chip_between_barriers == 0x12345678)
        scratch[0] = pack(Affine(on_chip_sink, on_chip_sink, on_chip_sink));
}
