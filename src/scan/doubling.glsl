// One round of doubling for one joint (scan/doubling_table.h), for `doubling` and `blocks64`, which differ in the
// chains and in what follows. The includer defines DOUBLING_LAST_SLOTS and DOUBLING_OTHER_SLOTS as the buffers that are
// used if the products do not fit in shared memory.
#include "scan/doubling_io.h"

CONSTANT(1, uint, kSharedJoints, 1);  // joints that shared memory holds
CONSTANT(2, bool, kInShared, true);   // false: the character does not fit
CONSTANT(3, bool, kReload, true);     // false: one joint per invocation, whose product stays in registers
CONSTANT(4, uint, kRounds, 1);

shared StoredAffine shared_products[2 * kSharedJoints];  // [slot][joint], the last slot first

Affine load_product(uint instance, uint joint, bool last_slot) {
    if (kInShared) return unpack(shared_products[(last_slot ? 0 : kSharedJoints) + joint]);
    if (last_slot) return unpack(DOUBLING_LAST_SLOTS[at(instance, joint)]);
    return unpack(DOUBLING_OTHER_SLOTS[at(instance, joint)]);
}

void store_product(uint instance, uint joint, bool last_slot, Affine product) {
    if (kInShared)
        shared_products[(last_slot ? 0 : kSharedJoints) + joint] = pack(product);
    else if (last_slot)
        DOUBLING_LAST_SLOTS[at(instance, joint)] = pack(product);
    else
        DOUBLING_OTHER_SLOTS[at(instance, joint)] = pack(product);
}

uint doubling_word(uint round, uint joint) { return link(round * push.joint_count + joint); }

// The product after round 0.
Affine first_product(uint instance, uint joint, uint word) {
    const Affine parent_from_joint = load_local(instance, joint);
    if ((word & kDoublingNoAncestor) != 0) return parent_from_joint;
    return affine_multiply(load_local(instance, word & kDoublingAncestorMask), parent_from_joint);
}

// The product after a later round that the joint takes part in. `product`: the previous one, used only if it stays in
// registers.
Affine next_product(uint instance, uint joint, uint word, Affine product) {
    if (kReload) product = load_product(instance, joint, (word & kDoublingToLast) == 0);
    return affine_multiply(load_product(instance, word & kDoublingAncestorMask, (word & kDoublingAncestorInLast) != 0),
                           product);
}
