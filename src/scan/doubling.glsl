// One round of doubling for one joint (scan/doubling_table.h): `doubling` and `blocks64` differ in the chains and in what follows.
// Before it is included, DOUBLING_LAST_SLOTS and DOUBLING_OTHER_SLOTS name the buffers that hold what shared memory cannot.
#include "scan/doubling_io.h"

layout(constant_id = 1) const uint kSharedJoints = 1;  // joints that shared memory holds
layout(constant_id = 2) const bool kInShared = true;   // false: the character does not fit it
layout(constant_id = 3) const bool kReload = true;     // false: a joint an invocation, whose product stays in registers

shared StoredAffine shared_last[kSharedJoints];
shared StoredAffine shared_other[kSharedJoints];

Affine load_product(uint instance, uint joint, bool last_slot) {
    if (kInShared && last_slot) return unpack(shared_last[joint]);
    if (kInShared) return unpack(shared_other[joint]);
    if (last_slot) return unpack(DOUBLING_LAST_SLOTS[at(instance, joint)]);
    return unpack(DOUBLING_OTHER_SLOTS[at(instance, joint)]);
}

void store_product(uint instance, uint joint, bool last_slot, Affine product) {
    if (kInShared && last_slot) shared_last[joint] = pack(product);
    else if (kInShared) shared_other[joint] = pack(product);
    else if (last_slot) DOUBLING_LAST_SLOTS[at(instance, joint)] = pack(product);
    else DOUBLING_OTHER_SLOTS[at(instance, joint)] = pack(product);
}

// The product after the round whose word this is; `product` is the invocation's last.
Affine doubled(uint instance, uint joint, uint round, uint word, Affine product) {
    const uint ancestor = word & kDoublingAncestorMask;
    if (round == 0) {
        product = load_local(instance, joint);
        if ((word & kDoublingNoAncestor) != 0) return product;
        return affine_multiply(load_local(instance, ancestor), product);
    }
    if (kReload) product = load_product(instance, joint, (word & kDoublingToLast) == 0);
    return affine_multiply(load_product(instance, ancestor, (word & kDoublingAncestorInLast) != 0), product);
}
