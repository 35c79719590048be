// Counts a workgroup's instances by verdict. A kernel calls count_begin(), then count() for each instance, then
// count_end(), each by all invocations.
#include "gpu/buffers_io.h"

WRITEONLY_BUFFER(kCountsBuffer, uint, counts);  // [workgroup][kCounters]

#ifdef __cplusplus

// One thread goes through a workgroup's instances, so it counts in the buffer itself.
void count_begin() {
    for (uint k = 0; k < kCounters; ++k) counts[gl_WorkGroupID.x * kCounters + k] = 0;
}

void count_one(uint counter) { ++counts[gl_WorkGroupID.x * kCounters + counter]; }

void count_end() {}

#else

shared uint found[kCounters];

void count_begin() {
    if (gl_LocalInvocationID.x < kCounters) found[gl_LocalInvocationID.x] = 0;
    barrier();
}

void count_one(uint counter) { atomicAdd(found[counter], 1); }

void count_end() {
    barrier();
    if (gl_LocalInvocationID.x < kCounters)
        counts[gl_WorkGroupID.x * kCounters + gl_LocalInvocationID.x] = found[gl_LocalInvocationID.x];
}

#endif

void count(uint verdict) {
    if (verdict == 0) return;
    if ((verdict & kVerdictDrawn) != 0) count_one(verdict & kVerdictLodMask);
    if ((verdict & kVerdictAnimated) != 0)
        count_one(kLodCount + (verdict >> kVerdictSectionShift & kVerdictSectionMask));
    if ((verdict & kVerdictInterpolated) != 0) count_one(kLodCount + kInterpolated);
    if ((verdict & kVerdictAppears) != 0) count_one(kLodCount + kAppearing);
}
