// list: writes the instances that are drawn, grouped by level, and those of each section of the work, in ascending
// order, so that the same view yields the same lists; and gives animated instances their own rows of a skin pool. One
// invocation per instance of a cell.
#include "gpu/buffers_io.h"
#include "cull/cull_io.h"

WORKGROUP_OF_STRIDE(kCullWorkgroupSize);
READONLY_BUFFER(kVerdictsBuffer, uint, verdicts);
READONLY_BUFFER(kCountsBuffer, uint, offsets);  // [workgroup][kCounters]
WRITEONLY_BUFFER(kListBuffer, uint, list);
BUFFER(kWorkBuffer, uint, work);
WRITEONLY_BUFFER(kSkinRowsBuffer, uint, skin_rows);
PUSH(CullPush);

// `at`: an index into the work, in which animated instances come first.
void list_animated(uint instance, uint at) {
    work[at] = instance;
    if (push.own_row_count == 0) return;
    const uint row = work[kOwnRowsBefore] + at - kFirstWork;
    if (row < push.own_row_count) skin_rows[instance] = push.first_own_row + row;
}

#ifdef __cplusplus

// One thread lists a workgroup's instances in order. It counts up from where the workgroup's part of each list begins.
void main() {
    uint next[kCounters];
    for (uint k = 0; k < kCounters; ++k) next[k] = offsets[gl_WorkGroupID.x * kCounters + k];
    const uint count = push.cells_of_workgroup * kCullWorkgroupSize, first = gl_WorkGroupID.x * count,
               end = min(first + count, push.instance_count);
    for (uint instance = first; instance < end; ++instance) {
        const uint verdict = verdicts[instance], section = verdict >> kVerdictSectionShift & kVerdictSectionMask;
        if (verdict == 0) continue;  // neither drawn nor animated
        if ((verdict & kVerdictDrawn) != 0) list[next[verdict & kVerdictLodMask]++] = instance;
        if ((verdict & kVerdictAnimated) != 0) list_animated(instance, next[kLodCount + section]++);
        if ((verdict & kVerdictInterpolated) != 0) work[next[kLodCount + kInterpolated]++] = instance;
        if ((verdict & kVerdictAppears) != 0) work[next[kLodCount + kAppearing]++] = instance;
    }
}

#else

// One byte per counter: how many invocations, up to and including this one, count towards it; at most 64
shared uvec4 ranks[2][kCullWorkgroupSize];
shared uint next[kCounters];  // where the next cell's instances begin, by counter

void list_cell(uint instance) {
    const uint invocation = gl_LocalInvocationID.x;
    const uint verdict = instance < push.instance_count ? verdicts[instance] : 0;
    const uint lod = verdict & kVerdictLodMask, section = verdict >> kVerdictSectionShift & kVerdictSectionMask;
    const bool is_drawn = (verdict & kVerdictDrawn) != 0, is_animated = (verdict & kVerdictAnimated) != 0,
               goes_on = (verdict & kVerdictInterpolated) != 0, appears = (verdict & kVerdictAppears) != 0;
    const uint of_section = is_animated ? 1u << 8 * (section % 4) : 0;
    uvec4 rank = uvec4(is_drawn ? 1u << 8 * lod : 0, section < 4 ? of_section : 0, section < 4 ? 0 : of_section,
                       (goes_on ? 1u : 0u) | (appears ? 256u : 0u));
    uint from = 0;
    ranks[from][invocation] = rank;
    barrier();
    for (uint distance_back = 1; distance_back < kCullWorkgroupSize; distance_back *= 2) {
        if (invocation >= distance_back) rank += ranks[from][invocation - distance_back];
        from = 1 - from;
        ranks[from][invocation] = rank;
        barrier();
    }
    if (is_drawn) list[next[lod] + bitfieldExtract(rank.x, int(8 * lod), 8) - 1] = instance;
    if (is_animated)
        list_animated(instance, next[kLodCount + section] +
                                    bitfieldExtract(section < 4 ? rank.y : rank.z, int(8 * (section % 4)), 8) - 1);
    if (goes_on) work[next[kLodCount + kInterpolated] + (rank.w & 255u) - 1] = instance;
    if (appears) work[next[kLodCount + kAppearing] + (rank.w >> 8) - 1] = instance;
    barrier();
    if (invocation < kCounters)
        next[invocation] += bitfieldExtract(ranks[from][kCullWorkgroupSize - 1][invocation / 4],
                                            int(8 * (invocation % 4)), 8);
    barrier();
}

void main() {
    const uint invocation = gl_LocalInvocationID.x;
    if (invocation < kCounters) next[invocation] = offsets[gl_WorkGroupID.x * kCounters + invocation];
    const uint first = gl_WorkGroupID.x * push.cells_of_workgroup * kCullWorkgroupSize + invocation;
    for (uint i = 0; i < push.cells_of_workgroup; ++i) list_cell(first + i * kCullWorkgroupSize);
}

#endif
