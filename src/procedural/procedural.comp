// procedural: rules that move joints after the blend and before the scan; defined in docs/procedural.md.
// One invocation per instance and chain; the chains of a dispatch are independent of each other. Reads 48 bytes for
// each joint of the chain and each of its ancestors, writes 48 for each joint of the chain (32 as similarities), and
// reads and writes 48 for each spring.
#include "gpu/buffers_io.h"
#include "control/births.glsl"
#include "gpu/stored.glsl"
#include "procedural/procedural_io.h"

WORKGROUP(kProceduralWorkgroupSize);
TABLE_OF_WORDS(kRulesBuffer, tables);
// [instance], world_from_model
READONLY_BUFFER(kPlacementsBuffer, StoredAffine, placements);
// [instance][target], world; w: weight
READONLY_BUFFER(kTargetsBuffer, vec4, targets);
// [instance][push.spring_count], three rows a SpringState
BUFFER(kSpringsBuffer, StoredRow, springs);
// [instance][joint], parent_from_joint
BUFFER(kLocalBuffer, StoredRow, local);
CONSTANT(1, bool, kSimilarity, false);
CONSTANT(2, uint, kKind, 0);  // of all chains; a constant, since a software device would run the code of all kinds
PUSH(ProceduralPush);

uint instance;

// ---- Loads and stores of the rules

WindSettings load_wind(uint word) { return WIND_SETTINGS_AT(tables, word); }
SpringSettings load_spring(uint word) { return SPRING_SETTINGS_AT(tables, word); }
LookAtSettings load_look_at(uint word) { return LOOK_AT_SETTINGS_AT(tables, word); }
ReachSettings load_reach(uint word) { return REACH_SETTINGS_AT(tables, word); }
ColliderShape load_collider(uint first, uint index) {
    return COLLIDER_SHAPE_AT(tables, first + kColliderShapeWords * index);
}
ProceduralJoint load_joint(ProceduralChain chain, uint k) {
    return PROCEDURAL_JOINT_AT(tables, chain.first_joint + kProceduralJointWords * k);
}
vec4 load_target(uint target) { return targets[instance * push.target_count + target]; }

uint parent_of(uint joint) { return WORD_AT(tables, joint); }
Affine placement() { return unpack(placements[instance]); }

Affine load_local(uint joint) {
    const uint index = instance * push.joint_count + joint;
    if (kSimilarity) return affine_from_similarity(Similarity(unpack(local[2 * index]), unpack(local[2 * index + 1])));
    return Affine(unpack(local[3 * index]), unpack(local[3 * index + 1]), unpack(local[3 * index + 2]));
}

// `turned`: parent_from_joint after `turn`.
void store_turned(uint joint, vec4 turn, Affine turned) {
    const uint index = instance * push.joint_count + joint;
    if (kSimilarity) {
        local[2 * index] = pack(quaternion_multiply(turn, unpack(local[2 * index])));
    } else {
        local[3 * index] = pack(turned.row0);
        local[3 * index + 1] = pack(turned.row1);
        local[3 * index + 2] = pack(turned.row2);
    }
}

uint spring_row(uint spring) { return 3 * (instance * push.spring_count + spring); }
SpringState load_spring_state(uint spring) {
    const uint row = spring_row(spring);
    const bool begins = is_newborn(instance, push.birth);
    return SpringState(unpack(springs[row]), unpack(springs[row + 1]), begins ? vec4(0) : unpack(springs[row + 2]));
}
void store_spring_state(uint spring, SpringState state) {
    const uint row = spring_row(spring);
    springs[row] = pack(state.place);
    springs[row + 1] = pack(state.velocity);
    springs[row + 2] = pack(state.origin);
}
void forget_spring(uint spring) { springs[spring_row(spring) + 2] = pack(vec4(0)); }

#include "gpu/angles.glsl"
#include "procedural/frames.glsl"
#include "procedural/wind.glsl"
#include "procedural/springs.glsl"
#include "procedural/aims.glsl"

void main() {
    instance = gl_WorkGroupID.x % push.workgroups * kProceduralWorkgroupSize + gl_LocalInvocationID.x;
    if (instance >= push.instance_count || !is_there(instance, push.birth)) return;
    const ProceduralChain chain = PROCEDURAL_CHAIN_AT(
        tables, push.first_chain + kProceduralChainWords * (gl_WorkGroupID.x / push.workgroups));
    move_chain(kKind, chain);
}
