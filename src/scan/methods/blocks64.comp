// blocks64: doubling inside blocks of 64 joints, then hops from block to block.
// Source: A GPU-based solution for large-scale skeletal animation simulation, Algorithm 3.
// Difference: only as many in-block rounds as the longest chain within a block needs; the source always does six. Two
//   slots per joint, so that nothing races, and the hops do not overwrite the in-block products that they read (as
//   printed, both steps overwrite data that others read). The first round reads local. One workgroup per character, so
//   that hops need no barrier between workgroups.
// Input: local[instance][joint], parent_from_joint, affine 3x4. Output: model[instance][joint], model_from_joint.
// Needs: 96 bytes of shared memory per joint; if they do not fit, uses model and scratch instead. Any joint count.
// Cost: longest thread at most 6 + (blocks crossed) multiplications; one barrier per in-block round, at most 6.
// Wins: GPUs, deep skeletons of few blocks.
// Loses: software devices, where barriers are expensive.
// Measured: docs/scan.md#blocks64
// Methods: blocks64
// Fused: blocks64
#define SCAN_EXCHANGE coherent
#define SCAN_SHARES
#include "scan/scan.glsl"
#define DOUBLING_LAST_SLOTS scratch
#define DOUBLING_OTHER_SLOTS model
#include "scan/doubling.glsl"

// The first ancestor outside the block, from the row of links[] after those of the rounds.
uint outside(uint joint) { return link(kRounds * push.joint_count + joint); }

void scan() {
    const uint instance = gl_WorkGroupID.x, thread = gl_LocalInvocationID.x, threads = gl_WorkGroupSize.x;
    Affine product = kIdentity;
    for (uint joint = thread; joint < push.joint_count; joint += threads) {
        const uint word = doubling_word(0, joint);
        product = first_product(instance, joint, word);
        store_product(instance, joint, (word & kDoublingToLast) != 0, product);
    }
    scan_barrier(!kInShared);
    for (uint round = 1; round < kRounds; ++round) {
        for (uint joint = thread; joint < push.joint_count; joint += threads) {
            const uint word = doubling_word(round, joint);
            if (word == kDoublingDone) continue;
            product = next_product(instance, joint, word, product);
            store_product(instance, joint, (word & kDoublingToLast) != 0, product);
        }
        scan_barrier(!kInShared);
    }

    // From block to block.
    for (uint joint = thread; joint < push.joint_count; joint += threads) {
        if (kReload) product = load_product(instance, joint, true);
        for (uint ancestor = outside(joint); ancestor != kNone; ancestor = outside(ancestor))
            product = affine_multiply(load_product(instance, ancestor, true), product);
        store_model(instance, joint, product);
    }
}
