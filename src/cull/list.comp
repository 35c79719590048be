#version 460
// list: instances that are drawn, those of a level together, in ascending order, so that the same view has the same list.
// One invocation per instance.
#include "cull/cull_io.h"

layout(local_size_x = kCullWorkgroupSize) in;
layout(set = 0, binding = 0, std430) readonly buffer Details { uint details[]; };
layout(set = 0, binding = 1, std430) readonly buffer Offsets { uvec4 offsets[]; };  // [workgroup]
layout(set = 0, binding = 2, std430) writeonly buffer List { uint list[]; };
layout(push_constant) uniform Push { CullPush push; };

shared uint ranks[2][kCullWorkgroupSize];  // a byte for each level: how many invocations up to this one have it; at most 64

void main() {
    const uint invocation = gl_LocalInvocationID.x, instance = gl_GlobalInvocationID.x;
    const uint detail = instance < push.instance_count ? details[instance] : kUnseen;
    uint rank = detail == kUnseen ? 0 : 1u << 8 * detail, from = 0;
    ranks[from][invocation] = rank;
    barrier();
    for (uint distance_back = 1; distance_back < kCullWorkgroupSize; distance_back *= 2) {
        if (invocation >= distance_back) rank += ranks[from][invocation - distance_back];
        from = 1 - from;
        ranks[from][invocation] = rank;
        barrier();
    }
    if (detail != kUnseen) list[kFirstListed + offsets[gl_WorkGroupID.x][detail] + bitfieldExtract(rank, int(8 * detail), 8) - 1] = instance;
}
