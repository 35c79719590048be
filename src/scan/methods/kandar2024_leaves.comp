// kandar2024_leaves: an invocation for each leaf walks its path from the root down.
// Source: Kandar, 2024, as the paper describes it.
// Difference: the path is a list made offline and walked downward. Walking upward, as the text suggests, forms products
//   that begin at the leaf. Of these only the last is a model transform, the leaf's, so they cannot fill in the
//   parents. Each joint is written by the first leaf (by index) below it, so that nothing is written twice. Small
//   skeletons share a workgroup.
// Input: local[instance][joint], parent_from_joint, affine 3x4. Output: model[instance][joint], model_from_joint.
// Needs: the paths of all leaves together within 16 Mi words; any joint count.
// Cost: sum over the leaves of (depth - 1) multiplications, longest thread levels - 1, no barrier, no shared memory.
// Wins: few levels, few leaves.
// Loses: deep skeletons with many leaves (combs).
// Measured: docs/scan.md#kandar2024_leaves
// Methods: kandar2024_leaves
#include "scan/scan.glsl"

CONSTANT(1, uint, kCharacters, 1);  // in a workgroup

// links[0] is the number of leaves. Then three indices into links[] follow for each leaf: the begin of its path, the
// begin of the joints that it writes, and the end of the path.
void scan() {
    const uint leaves = link(0);
    for (uint item = gl_LocalInvocationID.x; item < kCharacters * leaves; item += gl_WorkGroupSize.x) {
        const uint instance = gl_WorkGroupID.x * kCharacters + item / leaves;
        if (instance >= instance_count()) return;
        const uint entry = 1 + 3 * (item % leaves);
        const uint first_owned = link(entry + 1), end = link(entry + 2);
        uint word = link(entry), joint = link(word);
        Transform product = load_local(instance, joint);
        if (word >= first_owned) store_model(instance, joint, product);
        while (++word < end) {
            joint = link(word);
            product = multiply(product, load_local(instance, joint));
            if (word >= first_owned) store_model(instance, joint, product);
        }
    }
}
