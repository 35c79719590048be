#version 460
// serial: one invocation per character walks its joints in order, parents first.
// Source: how every CPU runtime does it (ozz-animation's LocalToModelJob, for one). Difference: the last joint's matrix is kept in
//   registers; joints are numbered depth first, so it is often the next one's parent.
// Input: local[instance][joint], parent_from_joint, affine 3x4.   Output: model[instance][joint], model_from_joint.
// Needs: nothing; any joint count.   Cost: joints - 1 multiplications on the one thread, no barrier, no shared memory.
// Wins: software devices, at any depth.   Loses: GPUs with fewer than some ten thousand characters; loads and stores lie a whole
//   character apart.   Measured: docs/scan.md#serial
#include "scan/scan.glsl"

void main() {
    const uint instance = gl_GlobalInvocationID.x;
    if (instance >= push.instance_count) return;
    const uint first = instance * push.joint_count;
    Affine last = kIdentity;
    for (uint joint = 0; joint < push.joint_count; ++joint) {
        const uint parent = links[joint];
        Affine model_from_parent = last;
        if (parent == kScanNoJoint) model_from_parent = kIdentity;
        else if (parent + 1 != joint) model_from_parent = model[first + parent];
        last = affine_multiply(model_from_parent, local[first + joint]);
        model[first + joint] = last;
    }
}
