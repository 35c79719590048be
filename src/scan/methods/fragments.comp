// fragments: cuts the skeleton into connected pieces, one for each invocation; scans over the pieces; then walks each
//   piece independently.
// Source: the work-efficient scan (Blelloch 1990; Harris, Sengupta, Owens, GPU Gems 3, 2007), which the paper cites but
//   does not use.
// Difference: on a tree, a block is a connected piece of joints. Instead of scanning each piece and correcting it
//   afterwards, an invocation first multiplies only the path through the piece above, down to its own attachment. The
//   scan over these products (doubling) gives the attachment's model transform, from which it walks its piece once.
//   Parents stay in registers: the subtree that needs the most slots comes last, and the few parents with children
//   still to come are kept in such slots, in shared memory.
// Input: local[instance][joint], parent_from_joint, affine 3x4. Output: model[instance][joint], model_from_joint.
// Needs: per piece, twice 48 bytes of shared memory and up to log2(joints of a piece) slots; any joint count.
// Cost: joints + paths + pieces * log2(levels of pieces) multiplications (376 to 508 for 300 joints in 32 pieces);
//   longest thread about 3 n / pieces; a barrier per round of the small scan, at most log2(pieces).
// Wins: GPUs with few characters; many levels.
// Loses: software devices, where idle lanes and barriers are expensive.
// Measured: docs/scan.md#fragments
// Methods: fragments
// Fused: fragments
#define SCAN_SHARES
#include "scan/scan.glsl"
#include "scan/pieces.glsl"

shared StoredTransform prefixes[2 * kThreads];

void scan() {
    const uint instance = gl_WorkGroupID.x, thread = gl_LocalInvocationID.x;
    Transform prefix = path_product(instance, thread);
    const uint rounds = link(kRounds);
    for (uint round = 0; round < rounds; ++round) {
        const uint half_first = (round & 1) * kThreads;  // the other half may still be read
        prefixes[half_first + thread] = pack(prefix);
        scan_barrier(false);
        const uint ancestor = ancestor_thread(thread, round);
        if (ancestor != kIdle) prefix = multiply(unpack(prefixes[half_first + ancestor]), prefix);
    }
    walk_piece(instance, thread, thread, prefix);
}
