// reveal: finds which instances in view are hidden behind what has been drawn, by a depth pyramid; those that waited
// and are not hidden are drawn too. Source: N. Greene, M. Kass and G. Miller, Hierarchical Z-Buffer Visibility,
// SIGGRAPH 1993; two passes as S. Haar and U. Aaltonen, GPU-Driven Rendering Pipelines, SIGGRAPH 2015. One invocation
// per instance of a cell. Cost: 56 bytes read, 8 written, 16 points projected, at most 16 depths read.
#include "gpu/buffers_io.h"
#include "cull/cull.glsl"

WORKGROUP(kCullWorkgroupSize);
BUFFER(kStatesBuffer, uint, states);
BUFFER(kVerdictsBuffer, uint, verdicts);
#include "cull/count.glsl"
#include "cull/shared_poses.glsl"
READONLY_BUFFER(kCoarserDepthsBuffer, float, pyramid);
PUSH(RevealPush);

#include "cull/occlusion.glsl"

void reveal_instance(CullView view, uint instance) {
    const Affine placement = AFFINE_AT(placement_rows, instance);
    uint verdict = verdicts[instance] & (kVerdictLodMask | kVerdictInView | kVerdictDrawn), state = states[instance];
    const bool hidden = (verdict & kVerdictInView) == 0 ||
                        is_hidden(view, placement, push.cull.centre.xyz, push.cull.half_extent.xyz);
    if ((verdict & kVerdictDrawn) != 0) {
        if (hidden) state &= ~kStateVisible;
    } else if (!hidden) {
        verdict = verdict_of(view, push.cull, placement, instance, state);
        verdict = shared_verdict(view, push.cull, placement, instance, verdict);
    }
    states[instance] = state;
    verdicts[instance] = verdict;
    count(verdict);
}

void main() {
    const uint first = gl_WorkGroupID.x * push.cull.cells_of_workgroup * kCullWorkgroupSize + gl_LocalInvocationID.x;
    count_begin();
    const CullView view = load_view();
    for (uint i = 0; i < push.cull.cells_of_workgroup; ++i) {
        const uint instance = first + i * kCullWorkgroupSize;
        if (instance < push.cull.instance_count) reveal_instance(view, instance);
    }
    count_end();
}
