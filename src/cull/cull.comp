// cull: which instances a view sees, each in which level of detail, and which of them are animated; and how many of
// each a workgroup has found. One invocation per instance. Cost: 52 bytes read, 8 written, some 100 operations.
#include "gpu/buffers_io.h"
#include "cull/cull.glsl"

WORKGROUP(kCullWorkgroupSize);
BUFFER(kStatesBuffer, uint, states);
WRITEONLY_BUFFER(kVerdictsBuffer, uint, verdicts);
#include "cull/count.glsl"
#include "cull/shared_poses.glsl"
PUSH(CullPush);

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
            verdict = shared_verdict(view, push, placement, instance, verdict);
        }
        states[instance] = state;
        verdicts[instance] = verdict;
        count(verdict);
    }
    count_end();
}
