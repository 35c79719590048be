// gateau2012_walk: every joint walks up to the root on its own.
// Source: Samuel Gateau, Massive Crowds on GPU, GTC 2012; Algorithm 1 of the paper.
// Difference: the printed loop stays at the joint's parent; here it moves on to the next ancestor. Reads local and
//   writes model, so that nothing races.
// Input: local[instance][joint], parent_from_joint, affine 3x4. Output: model[instance][joint], model_from_joint.
// Needs: nothing; any joint count.
// Cost: sum of (depth - 1) multiplications, longest thread levels - 1, no barrier, no shared memory.
// Wins: few levels.
// Loses: many levels, quadratically in a chain.
// Measured: docs/scan.md#gateau2012_walk
// Methods: gateau2012_walk
#include "scan/scan.glsl"

void scan() {
    const uint instance = gl_WorkGroupID.x;
    for (uint joint = gl_LocalInvocationID.x; joint < push.joint_count; joint += gl_WorkGroupSize.x) {
        Transform product = load_local(instance, joint);
        for (uint ancestor = link(joint); ancestor != kNone; ancestor = link(ancestor))
            product = multiply(load_local(instance, ancestor), product);
        store_model(instance, joint, product);
    }
}
