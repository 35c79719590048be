// serial, fused: one invocation a character samples, blends, multiplies and binds its joints in one walk.
// Source: scan/methods/serial.comp. Difference: parents are not read back. The walk is that of scan/pieces.h with a
//   single piece: the subtree that needs the most slots comes last, so that only the few parents with children still to
//   come wait in slots. Each segment of the walk begins with the joints whose translation and scale do not change.
//   These have a loop of their own, since a software device cannot skip the code of a branch, only leave a loop.
// Input: cursors, keys.   Output: skin[instance][entry], model[instance][joint] where asked for.
// Needs: a slot for each nested branching, at most log2(joints).   Cost: a multiplication and a sample per joint, on
//   one thread; no barrier; no shared memory on a software device; stores only the output.
// Wins: software devices.   Loses: GPUs with fewer than some ten thousand characters.   Measured: docs/performance.md
#include "scan/scan.glsl"
#include "scan/pieces_io.h"
#include "scan/slots.glsl"

Transform walk_last;

void walk(uint index, uint step, uint invocation, Transform parent_from_joint) {
    const uint parent = step >> kWalkParentShift & kWalkFieldMask, keep = step >> kWalkKeepShift & kWalkFieldMask;
    if (parent == kParentIsPrefix) walk_last = kIdentityTransform;
    walk_last = multiply(load_slot(parent - kParentInSlot, invocation, walk_last), parent_from_joint);
    store_model(index, step & kWalkJointMask, walk_last);
    store_slot(keep - 1, invocation, walk_last);
}

void scan() {
    const uint index = gl_GlobalInvocationID.x, invocation = gl_LocalInvocationID.x;
    if (index >= instance_count()) return;
    begin_instance(index);
    walk_last = kIdentityTransform;
    const uint segment_end = kFirstSegment + 2 * link(kSegmentCount);
    uint word = segment_end;
    for (uint segment = kFirstSegment; segment < segment_end; segment += 2) {
        const uint fixed_end = word + link(segment), free_end = fixed_end + link(segment + 1);
        for (; word < fixed_end; ++word) {
            const uint step = link(word);
            walk(index, step, invocation, load_local_of_fixed(step & kWalkJointMask));
        }
        for (; word < free_end; ++word) {
            const uint step = link(word);
            walk(index, step, invocation, load_local(index, step & kWalkJointMask));
        }
    }
}
