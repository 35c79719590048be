// doubling: in each round, every joint multiplies its product by the product of the ancestor twice as far up as in the
//   previous round.
// Source: Hillis and Steele, Data Parallel Algorithms, CACM, 1986; Algorithm 2 of the paper.
// Difference: ceil(log2(levels)) rounds, not log2(joints). Two slots per joint, so that one barrier per round is enough
//   and nothing races. The first round reads local, the last one writes model, and joints whose chains are complete
//   skip the rounds between.
// Input: local[instance][joint], parent_from_joint, affine 3x4. Output: model[instance][joint], model_from_joint.
// Needs: 96 bytes of shared memory per joint; if they do not fit, uses model and scratch instead. Any joint count.
// Cost: at most joints * ceil(log2(levels)) multiplications, longest thread ceil(log2(levels)), ceil(log2(levels)) - 1
//   barriers.
// Wins: GPUs, few characters.
// Loses: software devices, where barriers are expensive.
// Measured: docs/scan.md#doubling
// Methods: doubling
// Fused: doubling
#define SCAN_EXCHANGE coherent
#define SCAN_SHARES
#include "scan/scan.glsl"
#define DOUBLING_LAST_SLOTS model
#define DOUBLING_OTHER_SLOTS scratch
#include "scan/doubling.glsl"

void scan() {
    const uint instance = gl_WorkGroupID.x, thread = gl_LocalInvocationID.x, threads = gl_WorkGroupSize.x;
    Affine product = kIdentity;
    for (uint joint = thread; joint < push.joint_count; joint += threads) {
        const uint word = doubling_word(0, joint);
        product = first_product(instance, joint, word);
        if (kInShared && kRounds == 1)
            store_model(instance, joint, product);
        else
            store_product(instance, joint, (word & kDoublingToLast) != 0, product);
    }
    const uint rounds_in_slots = kInShared ? kRounds - 1 : kRounds;  // without shared memory the last slot is model
    for (uint round = 1; round < rounds_in_slots; ++round) {
        scan_barrier(!kInShared);
        for (uint joint = thread; joint < push.joint_count; joint += threads) {
            const uint word = doubling_word(round, joint);
            if (word == kDoublingDone) continue;
            product = next_product(instance, joint, word, product);
            store_product(instance, joint, (word & kDoublingToLast) != 0, product);
        }
    }
    if (!kInShared || kRounds == 1) return;
    scan_barrier(false);
    for (uint joint = thread; joint < push.joint_count; joint += threads) {
        const uint word = doubling_word(kRounds - 1, joint);
        if (word != kDoublingDone)
            product = next_product(instance, joint, word, product);
        else if (kReload)
            product = load_product(instance, joint, true);
        store_model(instance, joint, product);
    }
}
