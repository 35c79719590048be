// The work of an invocation on its piece of a skeleton (scan/pieces.h), for `fragments` and `subgroup`, which differ in
// how they combine the prefixes of pieces.
#include "scan/pieces_io.h"

CONSTANT(1, uint, kThreads, 1);  // pieces of a character, which is also its number of invocations

#include "scan/slots.glsl"

// The product from the top of the attachment's piece down to the attachment.
Transform path_product(uint instance, uint thread) {
    Transform product = kIdentityTransform;
    const uint rows = link(kPathRows);
    uint word = kFirstRow + thread;
    if (rows > 0 && link(word) != kIdle) product = load_local(instance, link(word));
    for (uint row = 1; row < rows; ++row) {
        word += kThreads;
        const uint joint = link(word);
        if (joint == kIdle) break;
        product = multiply(product, load_local(instance, joint));
    }
    return product;
}

uint ancestor_thread(uint thread, uint round) {
    return link(kFirstRow + (link(kPathRows) + round) * kThreads + thread);
}

// Multiplies `prefix`, the attachment's model transform, down the piece.
void walk_piece(uint instance, uint thread, uint invocation, Transform prefix) {
    const uint rows = link(kWalkRows);
    uint word = kFirstRow + (link(kPathRows) + link(kRounds)) * kThreads + thread;
    Transform last = prefix;
    for (uint row = 0; row < rows; ++row) {
        const uint step = link(word);
        if (step == kIdle) break;
        const uint joint = step & kWalkJointMask, parent = step >> kWalkParentShift & kWalkFieldMask,
                   keep = step >> kWalkKeepShift & kWalkFieldMask;
        if (parent == kParentIsPrefix) last = prefix;
        last = load_slot(parent - kParentInSlot, invocation, last);
        last = multiply(last, load_local(instance, joint));
        store_model(instance, joint, last);
        store_slot(keep - 1, invocation, last);
        word += kThreads;
    }
}
