// stream: processes joints in chunks, one joint per lane of a subgroup. Parents come by shuffles, or from slots.
// Source: doubling inside a chunk as in warp scans (Harris and Garland, GPU Computing Gems Jade, 2012); the order of
//   the joints by list scheduling (Hu, Operations Research 9 (6), 1961).
// Difference: a chunk holds any joints whose parents are in it or in earlier chunks. The order is found offline, for
//   few chunks, adjacent joints in a chunk (so that stores fill whole cache lines), few rounds and few slots. Each
//   local transform is loaded once, by the lane that stores the model transform, so that shared memory holds nothing
//   but the parents of joints in later chunks. Small characters share chunks. If there are few characters, several
//   subgroups share a large one: each does the rounds of a chunk of its own, then multiplies by the ancestors in
//   earlier chunks, one subgroup after the other.
// Input: local[instance][joint], parent_from_joint, affine 3x4. Output: model[instance][joint], model_from_joint.
//   stream_quaternion reads similarities.
// Needs: shuffles; lanes a power of two, at most a subgroup's; shared memory for the slots; any joint count.
// Cost: a multiplication per chunk and one per round; no barrier, or one per chunk if several subgroups share a
//   character.
// Wins: GPUs, especially fused: no tile of local transforms limits occupancy.
// Loses: software devices, on which shuffles and shared memory are slow.
// Measured: docs/scan.md#stream
// Methods: stream stream_quaternion
// Fused: stream stream_quaternion
// Untiled: stream stream_quaternion
// Rows: stream
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_shuffle : require
#include "scan/scan.glsl"
#include "scan/shuffled.glsl"
#include "scan/stream_io.h"

CONSTANT(1, uint, kLanes, 1);           // lanes of a chunk
CONSTANT(2, uint, kCharacters, 1);      // characters of a team
CONSTANT(3, uint, kSlots, 1);           // slots of a team
CONSTANT(4, uint, kSlotTransforms, 1);  // slots of the workgroup
// A team shares one or more characters. It is a subgroup, or a part of one; or several subgroups, which are then the
// whole workgroup, and each takes every kSubgroups-th chunk.
CONSTANT(5, uint, kSubgroups, 1);
shared StoredTransform slots[kSlotTransforms];

void scan() {
    uint team = gl_SubgroupID, lane = gl_SubgroupInvocationID, member = 0;
    if (kLanes < gl_SubgroupSize) {
        team = (gl_SubgroupID * gl_SubgroupSize + gl_SubgroupInvocationID) / kLanes;
        lane %= kLanes;
    }
    if (kSubgroups > 1) {
        member = team;
        team = 0;
    }
    const uint first_lane = gl_SubgroupInvocationID - lane, first_slot = team * kSlots - 1;  // words have 1 + slot
    const uint first_index = (gl_WorkGroupID.x * (gl_WorkGroupSize.x / (kLanes * kSubgroups)) + team) * kCharacters;
    if (kCharacters == 1 && first_index < instance_count()) begin_instance(first_index);

    const uint chunk_count = link(kChunkCount);
    for (uint first_chunk = 0; first_chunk < chunk_count; first_chunk += kSubgroups) {
        const uint chunk = first_chunk + member;
        uint joint_word = kStreamIdle, parent_word = lane, round_count = 0;
        if (kSubgroups == 1 || chunk < chunk_count) {
            const uint word = kFirstChunk + chunk_count + 2 * (chunk * kLanes + lane);
            joint_word = link(word);
            parent_word = link(word + 1);
            round_count = link(kFirstChunk + chunk);
        }
        const uint joint = joint_word & kStreamJointMask, keep = joint_word >> kStreamKeepShift;
        const uint from = parent_word >> kStreamSlotShift;
        uint index = first_index;
        if (kCharacters > 1) index += parent_word >> kStreamCharacterShift & kStreamCharacterMask;
        const bool exists = joint != kStreamIdle && index < instance_count();

        Transform transform = kIdentityTransform;
        if (exists) {
            if (kCharacters > 1) begin_instance(index);
            transform = load_local(index, joint);
        }
        uint ancestor = parent_word & kStreamLaneMask;
        for (uint round = round_count; round > 0; --round) {
            const Transform above = shuffled(transform, first_lane + ancestor);
            const uint next = subgroupShuffle(ancestor, first_lane + ancestor);
            if (ancestor != lane) transform = multiply(above, transform);
            ancestor = next == ancestor ? lane : next;  // if unchanged, the chunk has nothing above that ancestor
        }
        for (uint turn = 0; turn < kSubgroups; ++turn) {
            if (turn == member) {
                if (exists && from != 0) transform = multiply(unpack(slots[first_slot + from]), transform);
                subgroupBarrier();  // all have read the slots that are overwritten next
                if (exists && keep != 0) slots[first_slot + keep] = pack(transform);
                subgroupBarrier();
            }
            if (kSubgroups > 1) barrier();
        }
        if (exists) store_model(index, joint, transform);
    }
}
