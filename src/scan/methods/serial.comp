// serial: one invocation per character walks its joints in order, parents first.
// Source: common practice of CPU runtimes (for example ozz-animation's LocalToModelJob).
// Difference: the skeleton is stored as runs of joints in which each joint is the next one's parent, so that a parent
//   is read back only where a run begins. With depth-first numbering there are as many runs as leaves.
// Input: local[instance][joint], parent_from_joint, affine 3x4. Output: model[instance][joint], model_from_joint.
//   serial_quaternion reads similarities; serial_transposed has both arrays as [joint][instance].
// Needs: nothing; any joint count within the device's limit of loop iterations (scan/scan.cpp).
// Cost: joints - roots multiplications on one thread, no barrier, no shared memory.
// Wins: software devices, at any depth.
// Loses: GPUs with fewer than some ten thousand characters; loads and stores lie a whole character apart (transposed:
//   adjacent, which helps only GPUs).
// Measured: docs/scan.md#serial
// Methods: serial serial_quaternion serial_transposed
// Fused: serial
// Untiled: serial
// Native: serial serial_quaternion serial_transposed
#include "scan/scan.glsl"

// links[0] is the number of runs. Then for each run: its first joint, its end, the parent of its first joint.
void scan() {
    const uint instance = gl_GlobalInvocationID.x;
    if (instance >= instance_count()) return;
    for (uint word = 1, end = 1 + 3 * link(0); word < end; word += 3) {
        const uint end_joint = link(word + 1), parent = link(word + 2);
        Affine last = kIdentity;
        if (parent != kNone) last = unpack(model[at(instance, parent)]);
        for (uint joint = link(word); joint < end_joint; ++joint) {
            last = affine_multiply(last, to_affine(load_local(instance, joint)));
            model[at(instance, joint)] = pack(last);
        }
    }
}
