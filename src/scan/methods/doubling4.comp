// doubling4: doubling with three ancestors per round. Each joint multiplies its product by those of the ancestors at
//   once, twice and three times the round's distance, which is four times that of the previous round.
// Source: doubling; follows more links between two barriers, as in higher-radix parallel scans (Merrill and Grimshaw,
//   Parallel Scan for Stream Architectures, 2009).
// Difference: on a tree, an ancestor's own link leads to the next one, so a round's table has only one word per joint.
// Input: local[instance][joint], parent_from_joint, affine 3x4. Output: model[instance][joint], model_from_joint.
// Needs: 96 bytes of shared memory per joint; if they do not fit, uses model and scratch instead. Any joint count.
// Cost: longest thread 3 ceil(log4(levels)) multiplications, ceil(log4(levels)) - 1 barriers: half of doubling's
//   barriers for 1.5 times its multiplications.
// Wins: where barriers are expensive relative to multiplications.
// Loses: against doubling, where they are cheap.
// Measured: docs/scan.md#doubling4
// Methods: doubling4
// Fused: doubling4
#define SCAN_EXCHANGE coherent
#define SCAN_SHARES
#include "scan/scan.glsl"

CONSTANT(1, uint, kSharedJoints, 1);  // joints that shared memory holds
CONSTANT(2, bool, kInShared, true);   // false: the character does not fit
CONSTANT(3, uint, kRounds, 1);

shared StoredAffine shared_products[2 * kSharedJoints];  // [slot][joint]

// Rounds alternate between two slots, so that no slot is both read and written between two barriers. Without shared
// memory the last round's slot is model.
uint slot_of(uint round) { return (kRounds - 1 - round) % 2; }

// A joint's product before the round.
Affine load_product(uint instance, uint joint, uint round) {
    if (round == 0) return load_local(instance, joint);
    const uint slot = slot_of(round - 1);
    if (kInShared) return unpack(shared_products[slot * kSharedJoints + joint]);
    if (slot == 0) return unpack(model[at(instance, joint)]);
    return unpack(scratch[at(instance, joint)]);
}

void store_product(uint instance, uint joint, uint round, Affine product) {
    if (round + 1 == kRounds)
        store_model(instance, joint, product);
    else if (kInShared)
        shared_products[slot_of(round) * kSharedJoints + joint] = pack(product);
    else if (slot_of(round) == 0)
        model[at(instance, joint)] = pack(product);
    else
        scratch[at(instance, joint)] = pack(product);
}

void scan() {
    const uint instance = gl_WorkGroupID.x, thread = gl_LocalInvocationID.x, threads = gl_WorkGroupSize.x;
    for (uint round = 0; round < kRounds; ++round) {
        if (round > 0) scan_barrier(!kInShared);
        const uint links = round * push.joint_count;
        for (uint joint = thread; joint < push.joint_count; joint += threads) {
            Affine product = load_product(instance, joint, round);
            uint ancestor = link(links + joint);
            for (uint i = 0; i < 3 && ancestor != kNone; ++i) {
                product = affine_multiply(load_product(instance, ancestor, round), product);
                ancestor = link(links + ancestor);
            }
            store_product(instance, joint, round, product);
        }
    }
}
