// compressed: blocks of 64 joints; inside a block, first up to eight joints, then strides of eight; then hops from
//   block to block.
// Source: A GPU-based solution for large-scale skeletal animation simulation, Algorithm 4 (State compression), its
//   final method.
// Difference: each of the three steps reads one array and writes another (as printed, they race). Step two follows the
//   8th ancestors that are set up for it (as printed, it follows a variable of step one).
// Input: local[instance][joint], parent_from_joint, affine 3x4. Output: model[instance][joint], model_from_joint.
// Needs: 96 bytes of shared memory per joint; if they do not fit, uses model and scratch instead. Any joint count.
// Cost: longest thread 7 + 7 + (blocks crossed) multiplications, 2 barriers.
// Wins: GPUs, few barriers at any depth.
// Loses: software devices, where barriers are expensive.
// Measured: docs/scan.md#compressed
// Methods: compressed
// Fused: compressed
#define SCAN_EXCHANGE coherent
#define SCAN_SHARES
#include "scan/scan.glsl"

CONSTANT(1, uint, kSharedJoints, 1);  // joints that shared memory holds
CONSTANT(2, bool, kInShared, true);   // false: the character does not fit

// links[] has three words a joint: parent, 8th ancestor within the block, first ancestor outside the block.
const uint kParent = 0, kEighth = 1, kOutside = 2, kWords = 3;

shared StoredAffine shared_strides[kSharedJoints];
shared StoredAffine shared_blocks[kSharedJoints];

uint link(uint joint, uint word) { return link(joint * kWords + word); }

Affine load_stride(uint instance, uint joint) {
    if (kInShared) return unpack(shared_strides[joint]);
    return unpack(model[at(instance, joint)]);
}

Affine load_block(uint instance, uint joint) {
    if (kInShared) return unpack(shared_blocks[joint]);
    return unpack(scratch[at(instance, joint)]);
}

void scan() {
    const uint instance = gl_WorkGroupID.x, thread = gl_LocalInvocationID.x, threads = gl_WorkGroupSize.x;

    // Multiplies the joint and its nearest seven ancestors inside the block.
    for (uint joint = thread; joint < push.joint_count; joint += threads) {
        Affine product = load_local(instance, joint);
        const uint outside = link(joint, kOutside);
        uint ancestor = link(joint, kParent);
        for (uint i = 0; i < 7 && ancestor != outside; ++i) {
            product = affine_multiply(load_local(instance, ancestor), product);
            ancestor = link(ancestor, kParent);
        }
        if (kInShared)
            shared_strides[joint] = pack(product);
        else
            model[at(instance, joint)] = pack(product);
    }
    scan_barrier(!kInShared);

    // Continues in strides of eight, up to the block's edge.
    for (uint joint = thread; joint < push.joint_count; joint += threads) {
        Affine product = load_stride(instance, joint);
        for (uint ancestor = link(joint, kEighth); ancestor != kNone; ancestor = link(ancestor, kEighth))
            product = affine_multiply(load_stride(instance, ancestor), product);
        if (kInShared)
            shared_blocks[joint] = pack(product);
        else
            scratch[at(instance, joint)] = pack(product);
    }
    scan_barrier(!kInShared);

    // From block to block.
    for (uint joint = thread; joint < push.joint_count; joint += threads) {
        Affine product = load_block(instance, joint);
        for (uint ancestor = link(joint, kOutside); ancestor != kNone; ancestor = link(ancestor, kOutside))
            product = affine_multiply(load_block(instance, ancestor), product);
        store_model(instance, joint, product);
    }
}
