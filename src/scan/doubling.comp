#version 460
// doubling: in each round every joint multiplies its product by that of the ancestor twice as far up as in the round before.
// Source: Hillis and Steele, Data Parallel Algorithms, CACM, 1986; Algorithm 2 of the paper. Difference: ceil(log2(levels)) rounds,
//   not log2(joints); two slots a joint, so that a barrier a round is enough and nothing races; the first round reads local, and a
//   joint whose chain is complete writes its result and rests.
// Input: local[instance][joint], parent_from_joint, affine 3x4.   Output: model[instance][joint], model_from_joint.
// Needs: 96 bytes of shared memory a joint where they fit, else model and scratch hold what shared memory would; any joint count.
// Cost: at most joints * ceil(log2(levels)) multiplications, longest thread ceil(log2(levels)), ceil(log2(levels)) - 1 barriers.
// Wins: GPUs, few characters.   Loses: software devices, where barriers are dear.   Measured: docs/scan.md#doubling
#define SCAN_EXCHANGE coherent
#define SCAN_SHARES
#include "scan/scan.glsl"
#define DOUBLING_LAST_SLOTS model
#define DOUBLING_OTHER_SLOTS scratch
#include "scan/doubling.glsl"

void scan() {
    const uint instance = gl_WorkGroupID.x, rounds = links[0];
    Affine product = kIdentity;
    for (uint round = 0; round < rounds; ++round) {
        if (round > 0) scan_barrier(!kInShared);
        for (uint joint = gl_LocalInvocationID.x; joint < push.joint_count; joint += gl_WorkGroupSize.x) {
            const uint word = links[1 + round * push.joint_count + joint];
            if (word == kDoublingDone) continue;
            product = doubled(instance, joint, round, word, product);
            const bool completes = (word & kDoublingCompletes) != 0;
            if (completes) store_model(instance, joint, product);
            const bool is_read_later = kInShared ? round + 1 < rounds : !completes;  // without shared memory the last slot is model
            if (is_read_later) store_product(instance, joint, (word & kDoublingToLast) != 0, product);
        }
    }
}
