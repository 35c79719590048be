#version 460
// cull: which instances a view sees, each in which level of detail, and which of them are animated; and how many of
// each a workgroup has found. One invocation per instance. Cost: 52 bytes read, 8 written, some 100 operations.
#include "gpu/buffers_io.h"
#include "cull/cull.glsl"

layout(local_size_x = kCullWorkgroupSize) in;
layout(set = 0, binding = kStatesBuffer, std430) buffer States { uint states[]; };
layout(set = 0, binding = kVerdictsBuffer, std430) writeonly buffer Verdicts { uint verdicts[]; };
#include "cull/count.glsl"
layout(push_constant) uniform Push { CullPush push; };

void main() {
    const uint instance = gl_GlobalInvocationID.x;
    count_begin();
    if (instance < push.instance_count) {
        const CullView view = load_view();
        const Affine placement = AFFINE_AT(placement_rows, instance);
        uint verdict = 0, state = states[instance];
        const bool waits = view.occlusion != 0 && (state & kStateVisible) == 0;
        if (!is_seen(view, placement, push.centre.xyz, push.half_extent.xyz)) {
            state = 0;
        } else if (waits) {
            verdict = kVerdictInView;
            state = 0;
        } else {
            verdict = verdict_of(view, push, placement, instance, state);
        }
        states[instance] = state;
        verdicts[instance] = verdict;
        count(verdict);
    }
    count_end();
}
