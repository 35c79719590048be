// cull: finds which instances a view sees, in which level of detail, and which of them are animated, and counts them
// for each workgroup. Tests cells first, then the instances of the cells that are seen, one invocation each. Cost: 32
// bytes for a cell that is not seen, and 8 written for each of its instances; for other instances 52 bytes read, 8
// written, some 100 operations.
#include "gpu/buffers_io.h"
#include "control/births.glsl"
#include "cull/cull.glsl"

WORKGROUP_OF_STRIDE(kCullWorkgroupSize);
BUFFER(kStatesBuffer, uint, states);
WRITEONLY_BUFFER(kVerdictsBuffer, uint, verdicts);
READONLY_BUFFER(kCellsBuffer, Cell, cells);
#include "cull/count.glsl"
#include "cull/shared_poses.glsl"
PUSH(CullPush);

// The box is in world space. Its top is above that of each instance, so its shadow reaches at least as far.
bool is_cell_seen(CullView view, uint number) {
    if (push.placements_version == 0) return true;
    const Cell cell = cells[number];
    if (cell.middle.w != push.placements_version) return true;  // not made yet, or never submitted
    const Affine world_from_world = Affine(vec4(1, 0, 0, 0), vec4(0, 1, 0, 0), vec4(0, 0, 1, 0));
    return is_seen(view, world_from_world, cell.middle.xyz, cell.half_extent.xyz);
}

void cull_instance(CullView view, uint instance, bool is_in_seen_cell) {
    uint verdict = 0, state = 0;
    const bool is_here = is_there(instance, push.birth);
    if (is_in_seen_cell && is_here) {
        const Affine placement = AFFINE_AT(placement_rows, instance);
        if (!is_newborn(instance, push.birth)) state = states[instance];
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
    }
    if (push.animates_unlisted != 0 && is_here) verdict |= kVerdictAnimated | kAnimated << kVerdictSectionShift;
    states[instance] = state;
    verdicts[instance] = verdict;
    count(verdict);
}

#ifdef __cplusplus

// One thread goes through a workgroup's instances.
void main() {
    count_begin();
    const CullView view = load_view();
    for (uint i = 0; i < push.cells_of_workgroup; ++i) {
        const uint cell = gl_WorkGroupID.x * push.cells_of_workgroup + i, first = cell * kCullWorkgroupSize,
                   end = min(first + kCullWorkgroupSize, push.instance_count);
        if (first >= end) return;
        const bool is_seen_at_all = is_cell_seen(view, cell);
        for (uint instance = first; instance < end; ++instance) cull_instance(view, instance, is_seen_at_all);
    }
}

#else

shared uint seen_cells[kMaxCells];

void main() {
    count_begin();
    const CullView view = load_view();
    const uint invocation = gl_LocalInvocationID.x, first_cell = gl_WorkGroupID.x * push.cells_of_workgroup;
    if (invocation < push.cells_of_workgroup && (first_cell + invocation) * kCullWorkgroupSize < push.instance_count)
        seen_cells[invocation] = is_cell_seen(view, first_cell + invocation) ? 1 : 0;
    barrier();
    for (uint i = 0; i < push.cells_of_workgroup; ++i) {
        const uint instance = (first_cell + i) * kCullWorkgroupSize + invocation;
        if (instance < push.instance_count) cull_instance(view, instance, seen_cells[i] != 0);
    }
    count_end();
}

#endif
