// levels: computes the skeleton level by level, with a barrier between levels.
// Source: common practice on GPUs.
// Difference: only as many invocations as the widest level has joints. Shared memory holds the joints with children of
//   two adjacent levels, alternating.
// Input: local[instance][joint], parent_from_joint, affine 3x4. Output: model[instance][joint], model_from_joint.
// Needs: 96 bytes of shared memory for each joint with children, of the level that has most of them; if they do not
//   fit, reads parents back from model. Any joint count within the device's limit of loop iterations.
// Cost: joints - roots multiplications, longest thread about levels - 1, levels - 1 barriers.
// Wins: wide, flat skeletons on GPUs.
// Loses: many levels: a barrier for each.
// Measured: docs/scan.md#levels
// Methods: levels
// Fused: levels
#define SCAN_EXCHANGE coherent
#define SCAN_SHARES
#include "scan/scan.glsl"

CONSTANT(1, uint, kSharedJoints, 1);  // joints of a level that shared memory holds
CONSTANT(2, bool, kInShared, true);   // false: they do not fit

shared StoredAffine shared_models[2 * kSharedJoints];

Affine load_parent(uint instance, uint level, uint parent) {
    if (kInShared) return unpack(shared_models[(level + 1) % 2 * kSharedJoints + parent]);
    return unpack(model[at(instance, parent)]);
}

// links[]: the number of levels; two words for each level, its first item and the end of its items with children; the
// end of all items; then the items by level, those with children first. An item has the joint in its low half, and in
// its high half the parent: its position in its level or, if shared memory does not hold the levels, its joint index.
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
