// subgroup: fragments within a subgroup, without barriers; a subgroup holds one character or several small ones.
// Source: fragments; registers are exchanged by shuffles as in warp scans (Harris and Garland, GPU Computing Gems Jade,
//   2012).
// Difference: as in fragments. With one lane per character it is a serial walk that reads no parents back.
// Input: local[instance][joint], parent_from_joint, affine 3x4. Output: model[instance][joint], model_from_joint.
//   subgroup_quaternion reads similarities.
// Needs: shuffles; lanes a power of two, at most the smallest subgroup; shared memory for the slots; any joint count.
// Cost: as fragments; no barrier.
// Wins: GPUs; software devices with fewer characters than lanes.
// Loses: where the driver's shuffles are slow.
// Measured: docs/scan.md#subgroup
// Methods: subgroup subgroup_quaternion
// Fused: subgroup subgroup_quaternion
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_shuffle : require
#include "scan/scan.glsl"
#include "scan/pieces.glsl"
#include "scan/shuffled.glsl"

void scan() {
    const uint invocation = gl_SubgroupID * gl_SubgroupSize + gl_SubgroupInvocationID, lane = invocation % kThreads;
    const uint instance = gl_WorkGroupID.x * (gl_WorkGroupSize.x / kThreads) + invocation / kThreads;
    const bool exists = instance < instance_count();  // the same for all lanes of a character

    Transform prefix = kIdentityTransform;
    if (exists) prefix = path_product(instance, lane);
    const uint rounds = link(kRounds);
    for (uint round = 0; round < rounds; ++round) {
        const uint ancestor = ancestor_thread(lane, round);
        uint source = gl_SubgroupInvocationID;
        if (ancestor != kIdle) source += ancestor - lane;
        const Transform above = shuffled(prefix, source);
        if (ancestor != kIdle) prefix = multiply(above, prefix);
    }
    if (exists) walk_piece(instance, lane, invocation, prefix);
}
