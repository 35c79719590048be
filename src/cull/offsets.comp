// offsets: counts of workgroups -> where each writes into the list and the work; and what is dispatched and drawn for
// them. One workgroup for a batch.
#include "gpu/buffers_io.h"
#include "cull/cull_io.h"

WORKGROUP_OF_STRIDE(kCullWorkgroupSize);
// [workgroup][kCounters / 4]: read as counts, replaced by where each one's instances begin
BUFFER(kCountsBuffer, uvec4, counts);
WRITEONLY_BUFFER(kListBuffer, uint, list);
BUFFER(kWorkBuffer, uint, work);
// [kWorkSections + 1] of three words
WRITEONLY_BUFFER(kDispatchesBuffer, uint, dispatches);
BUFFER(kDrawsBuffer, DrawCommand, draws);  // [section][kLodCount]
PUSH(OffsetsPush);

shared uint totals[kCounters];
shared uint begins[kCounters];
shared uint own_rows_before;

void set_dispatch(uint command, uint workgroups) {
    dispatches[3 * command] = workgroups;
    dispatches[3 * command + 1] = 1;
    dispatches[3 * command + 2] = 1;
}

// How many instances of a section are animated: with a skin pool, only as many as there are rows left for.
uint count_of(uint section) {
    const uint total = totals[kLodCount + section];
    if (push.own_row_count == 0 || section >= kInterpolated) return total;
    const uint before = own_rows_before + begins[kLodCount + section] - kFirstWork;
    return min(total, push.own_row_count - min(before, push.own_row_count));
}

void begin_rows() { own_rows_before = push.is_second_half != 0 ? work[kOwnRowsTaken] : 0; }

// Writes the indirect dispatches and draws, from the totals.
void tell(uint invocation) {
    for (uint i = invocation; i < push.section_count * kLodCount; i += kCullWorkgroupSize)
        draws[i].instance_count = totals[i % kLodCount];
    if (invocation < kLodCount) list[kListBegins + invocation] = begins[invocation] - kFirstListed;
    const uint drawn_count = totals[0] + totals[1] + totals[2] + totals[3];
    if (invocation == 0) list[kListCount] = drawn_count;
    if (invocation == kWorkSections) {
        set_dispatch(kWorkSections, drawn_count);
        uint taken = own_rows_before;
        for (uint section = 0; section < kInterpolated; ++section) taken += count_of(section);
        work[kOwnRowsBefore] = own_rows_before;
        work[kOwnRowsTaken] = taken;
    }
    if (invocation >= kWorkSections) return;
    const uint count = count_of(invocation);
    const uint instances_of_workgroup = invocation < kInterpolated ? push.instances_of_workgroup[invocation % kLodCount]
                                                                   : 1;
    work[2 * invocation] = begins[kLodCount + invocation];
    work[2 * invocation + 1] = count;
    set_dispatch(invocation, (count + instances_of_workgroup - 1) / instances_of_workgroup);
}

#ifdef __cplusplus

// One thread goes through all workgroups.
void main() {
    begin_rows();
    uvec4 sums[kCounters / 4] = {};
    for (uint i = 0; i < push.workgroup_count; ++i)
        for (uint k = 0; k < kCounters / 4; ++k) sums[k] += counts[i * (kCounters / 4) + k];
    uint at = kFirstListed;
    for (uint k = 0; k < kCounters; ++k) {
        if (k == kLodCount) at = kFirstWork;
        totals[k] = sums[k / 4][k % 4];
        begins[k] = at;
        sums[k / 4][k % 4] = at;
        at += totals[k];
    }
    for (uint i = 0; i < push.workgroup_count; ++i)
        for (uint k = 0; k < kCounters / 4; ++k) {
            const uvec4 count = counts[i * (kCounters / 4) + k];
            counts[i * (kCounters / 4) + k] = sums[k];
            sums[k] += count;
        }
    for (uint invocation = 0; invocation < kCullWorkgroupSize; ++invocation) tell(invocation);
}

#else

shared uvec4 sums[kCullWorkgroupSize][kCounters / 4];

void main() {
    const uint invocation = gl_LocalInvocationID.x;
    if (invocation == 0) begin_rows();
    const uint share = (push.workgroup_count + kCullWorkgroupSize - 1) / kCullWorkgroupSize;
    const uint begin = min(invocation * share, push.workgroup_count), end = min(begin + share, push.workgroup_count);
    for (uint k = 0; k < kCounters / 4; ++k) {
        uvec4 sum = uvec4(0);
        for (uint i = begin; i < end; ++i) sum += counts[i * (kCounters / 4) + k];
        sums[invocation][k] = sum;
    }
    barrier();
    if (invocation < kCounters) {
        uint total = 0;
        for (uint i = 0; i < kCullWorkgroupSize; ++i) total += sums[i][invocation / 4][invocation % 4];
        totals[invocation] = total;
    }
    barrier();
    if (invocation < kCounters) {
        const bool is_drawn = invocation < kLodCount;
        uint at = is_drawn ? kFirstListed : kFirstWork;
        for (uint i = is_drawn ? 0 : kLodCount; i < invocation; ++i) at += totals[i];
        begins[invocation] = at;
    }
    barrier();
    for (uint k = 0; k < kCounters / 4; ++k) {
        uvec4 at = uvec4(begins[4 * k], begins[4 * k + 1], begins[4 * k + 2], begins[4 * k + 3]);
        for (uint i = 0; i < invocation; ++i) at += sums[i][k];
        for (uint i = begin; i < end; ++i) {
            const uvec4 count = counts[i * (kCounters / 4) + k];
            counts[i * (kCounters / 4) + k] = at;
            at += count;
        }
    }
    tell(invocation);
}

#endif
