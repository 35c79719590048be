// levels: level after level of the skeleton, a barrier between two.
// Source: common practice on GPUs.
// Difference: invocations for the widest level only, and shared memory for the joints with children of two adjacent
//   levels, which take turns.
// Input: local[instance][joint], parent_from_joint, affine 3x4. Output: model[instance][joint], model_from_joint.
// Needs: 96 bytes of shared memory for each joint with children of the widest level where they fit, else parents are
//   read back from model; any joint count that the device's loops can count.
// Cost: joints - roots multiplications, longest thread about levels - 1, levels - 1 barriers.
// Wins: wide, flat skeletons on GPUs.
// Loses: many levels: a barrier for each.
// Measured: docs/scan.md#levels
// Methods: levels
// Fused: levels
#define SCAN_EXCHANGE coherent
#define SCAN_SHARES
#include "scan/scan.glsl"

CONSTANT(1, uint, kSharedJoints, 1);  // of a level
CONSTANT(2, bool, kInShared, true);   // false: they do not fit

shared StoredAffine shared_models[2 * kSharedJoints];

Affine load_parent(uint instance, uint level, uint parent) {
    if (kInShared) return unpack(shared_models[(level + 1) % 2 * kSharedJoints + parent]);
    return unpack(model[at(instance, parent)]);
}

// links[0] is the number of levels; for each level two words follow, its first item and the end of those with children,
// then the end of all items, then the items, by level, those with children first: the joint in the low half; in the
// high half its parent, as the position in its level, or as a joint where shared memory does not hold the levels.
void scan() {
    const uint instance = gl_WorkGroupID.x, level_count = link(0), items = 2 + 2 * level_count;
    for (uint level = 0; level < level_count; ++level) {
        if (level > 0) scan_barrier(!kInShared);
        const uint first = link(1 + 2 * level), parents_end = link(2 + 2 * level), end = link(3 + 2 * level);
        for (uint item = first + gl_LocalInvocationID.x; item < end; item += gl_WorkGroupSize.x) {
            const uint word = link(items + item), joint = word & 0xFFFF;
            Affine product = load_local(instance, joint);
            if (level > 0) product = affine_multiply(load_parent(instance, level, word >> 16), product);
            if (kInShared && item < parents_end)
                shared_models[level % 2 * kSharedJoints + item - first] = pack(product);
            store_model(instance, joint, product);
        }
    }
}
