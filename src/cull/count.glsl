// How many instances of a workgroup have which verdict. A kernel calls count_begin(), then count() for each instance,
// then count_end(), each by all invocations.
#include "gpu/buffers_io.h"

WRITEONLY_BUFFER(kCountsBuffer, uint, counts);  // [workgroup][kCounters]

shared uint found[kCounters];

void count_begin() {
    if (gl_LocalInvocationID.x < kCounters) found[gl_LocalInvocationID.x] = 0;
    barrier();
}

void count(uint verdict) {
    if ((verdict & kVerdictDrawn) != 0) atomicAdd(found[verdict & kVerdictLodMask], 1);
    if ((verdict & kVerdictAnimated) != 0)
        atomicAdd(found[kLodCount + (verdict >> kVerdictSectionShift & kVerdictSectionMask)], 1);
    if ((verdict & kVerdictGoesOn) != 0) atomicAdd(found[kLodCount + kGoingOn], 1);
    if ((verdict & kVerdictAppears) != 0) atomicAdd(found[kLodCount + kAppearing], 1);
}

void count_end() {
    barrier();
    if (gl_LocalInvocationID.x < kCounters)
        counts[gl_WorkGroupID.x * kCounters + gl_LocalInvocationID.x] = found[gl_LocalInvocationID.x];
}
