#version 460
// offsets: counts of workgroups -> where each writes into the list; and what is dispatched and drawn for it. One workgroup for a batch.
#include "cull/cull_io.h"

layout(local_size_x = kCullWorkgroupSize) in;
layout(set = 0, binding = 0, std430) buffer Counts { uvec4 counts[]; };         // [workgroup]: before, how many; after, where they begin in the list
layout(set = 0, binding = 1, std430) writeonly buffer List { uint list[]; };
layout(set = 0, binding = 2, std430) writeonly buffer Dispatch { uint dispatch[]; };
layout(set = 0, binding = 3, std430) buffer Draws { DrawCommand draws[]; };     // [section][kDetailLevels]
layout(push_constant) uniform Push { OffsetsPush push; };

shared uvec4 sums[kCullWorkgroupSize];

void main() {
    const uint invocation = gl_LocalInvocationID.x;
    const uint share = (push.workgroup_count + kCullWorkgroupSize - 1) / kCullWorkgroupSize;
    const uint begin = min(invocation * share, push.workgroup_count), end = min(begin + share, push.workgroup_count);
    uvec4 sum = uvec4(0);
    for (uint i = begin; i < end; ++i) sum += counts[i];
    sums[invocation] = sum;
    barrier();
    uvec4 before = uvec4(0), total = uvec4(0);
    for (uint i = 0; i < kCullWorkgroupSize; ++i) {
        if (i < invocation) before += sums[i];
        total += sums[i];
    }
    const uvec4 begins = uvec4(0, total.x, total.x + total.y, total.x + total.y + total.z);
    uvec4 at = begins + before;
    for (uint i = begin; i < end; ++i) {
        const uvec4 count = counts[i];
        counts[i] = at;
        at += count;
    }
    for (uint i = invocation; i < push.section_count * kDetailLevels; i += kCullWorkgroupSize) draws[i].instance_count = total[i % kDetailLevels];
    if (invocation < kDetailLevels) list[kListBegins + invocation] = begins[invocation];
    if (invocation > 0) return;
    const uint drawn = begins.w + total.w;
    list[kListCount] = drawn;
    dispatch[0] = (drawn + push.instances_of_workgroup - 1) / push.instances_of_workgroup;
    dispatch[1] = 1;
    dispatch[2] = 1;
}
