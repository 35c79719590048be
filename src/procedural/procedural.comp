#version 460
// procedural: rules that move joints after the blend and before the scan; defined in docs/procedural.md.
// One invocation per instance and chain; the chains of a dispatch touch nothing of each other. Reads 48 bytes a joint
// of the chain and of all above it, writes 48 a joint (32 each as similarities), and reads and writes 48 a spring.
#include "gpu/buffers_io.h"
#include "gpu/table.glsl"
#include "gpu/stored.glsl"
#include "procedural/procedural_io.h"

layout(local_size_x = kProceduralWorkgroupSize) in;
TABLE_OF_WORDS(kRulesBuffer, Tables, tables);
// [instance], world_from_model
layout(set = 0, binding = kPlacementsBuffer, std430) readonly buffer Placements { StoredAffine placements[]; };
// [instance][target], world; w: weight
layout(set = 0, binding = kTargetsBuffer, std430) readonly buffer Targets { vec4 targets[]; };
// [instance][push.spring_count], three rows a SpringState
layout(set = 0, binding = kSpringsBuffer, std430) buffer Springs { StoredRow springs[]; };
// [instance][joint], parent_from_joint
layout(set = 0, binding = kLocalBuffer, std430) buffer Local { StoredRow local[]; };
layout(constant_id = 1) const bool kSimilarity = false;
layout(constant_id = 2) const uint kKind = 0;  // of the chains: a software device would run the code of all
layout(push_constant) uniform Push { ProceduralPush push; };

uint instance;

uint first_joint_of(ProceduralChain chain) { return WORD_AT(tables, chain.first_joint); }

#include "procedural/frames.glsl"

ProceduralJoint load_joint(ProceduralChain chain, uint k) {
    return PROCEDURAL_JOINT_AT(tables, chain.first_joint + kProceduralJointWords * k);
}

#include "procedural/wind.glsl"
#include "procedural/springs.glsl"
#include "procedural/aims.glsl"

void main() {
    instance = gl_WorkGroupID.x % push.workgroups * kProceduralWorkgroupSize + gl_LocalInvocationID.x;
    if (instance >= push.instance_count) return;
    const ProceduralChain chain = PROCEDURAL_CHAIN_AT(
        tables, push.first_chain + kProceduralChainWords * (gl_WorkGroupID.x / push.workgroups));
    if (kKind == kChainWind)
        bend_in_wind(chain);
    else if (kKind == kChainSpring)
        swing(chain);
    else if (kKind == kChainLookAt)
        look_at(chain);
    else
        reach(chain);
}
