// What an invocation does with its piece of a skeleton (scan/pieces.h): `fragments` and `subgroup` differ in how prefixes are combined.
#include "scan/pieces_io.h"

layout(constant_id = 1) const uint kLanes = 1;            // pieces, and invocations of a character
layout(constant_id = 2) const uint kSlotTransforms = 1;   // slots of the whole workgroup

shared StoredTransform slots[kSlotTransforms];  // [slot][invocation]

// The product from the top of the attachment's piece down to the attachment.
Transform path_product(uint instance, uint lane) {
    Transform product = kIdentityTransform;
    const uint rows = links[kPathRows];
    uint word = kFirstRow + lane;
    if (rows > 0 && links[word] != kIdle) product = load_local(instance, links[word]);
    for (uint row = 1; row < rows; ++row) {
        word += kLanes;
        const uint joint = links[word];
        if (joint == kIdle) break;
        product = multiply(product, load_local(instance, joint));
    }
    return product;
}

uint ancestor_lane(uint lane, uint round) { return links[kFirstRow + (links[kPathRows] + round) * kLanes + lane]; }

// Multiplies `prefix`, the attachment's model transform, down the piece.
void walk_piece(uint instance, uint lane, uint invocation, Transform prefix) {
    const uint rows = links[kWalkRows];
    uint word = kFirstRow + (links[kPathRows] + links[kRounds]) * kLanes + lane;
    Transform last = prefix;
    for (uint row = 0; row < rows; ++row) {
        const uint step = links[word];
        if (step == kIdle) break;
        const uint joint = step & kWalkJointMask, parent = step >> kWalkParentShift & kWalkFieldMask, keep = step >> kWalkKeepShift & kWalkFieldMask;
        if (parent == kParentIsPrefix) last = prefix;
        if (parent >= kParentInSlot) last = unpack(slots[(parent - kParentInSlot) * gl_WorkGroupSize.x + invocation]);
        last = multiply(last, load_local(instance, joint));
        store_model(instance, joint, last);
        if (keep > 0) slots[(keep - 1) * gl_WorkGroupSize.x + invocation] = pack(last);
        word += kLanes;
    }
}
