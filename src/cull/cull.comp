#version 460
// cull: which instances a view sees, each in which level of detail; and how many of each level a workgroup has found.
// One invocation per instance. Cost: 48 bytes read, 4 written, some 100 operations.
#include "cull/cull.glsl"

layout(local_size_x = kCullWorkgroupSize) in;
layout(set = 0, binding = 0, std430) readonly buffer View { CullView view; };
layout(set = 0, binding = 1, std430) readonly buffer Placements { Affine world_from_model[]; };
layout(set = 0, binding = 2, std430) writeonly buffer Details { uint details[]; };
layout(set = 0, binding = 3, std430) writeonly buffer Counts { uvec4 counts[]; };  // [workgroup], of each level
layout(push_constant) uniform Push { CullPush push; };

shared uint found[kDetailLevels];

void main() {
    const uint invocation = gl_LocalInvocationID.x, instance = gl_GlobalInvocationID.x;
    if (invocation < kDetailLevels) found[invocation] = 0;
    barrier();
    if (instance < push.instance_count) {
        const Affine placement = world_from_model[instance];
        uint detail = kUnseen;
        if (is_seen(view, placement, push.centre.xyz, push.half_extent.xyz))
            detail = detail_of(view, placement, push.centre.xyz, push.half_extent.xyz, push.detail_errors, push.detail_count);
        details[instance] = detail;
        if (detail != kUnseen) atomicAdd(found[detail], 1);
    }
    barrier();
    if (invocation == 0) counts[gl_WorkGroupID.x] = uvec4(found[0], found[1], found[2], found[3]);
}
