// Where native updates compute, on native and software devices: threads of throng's own, or the application's.
#pragma once

#include <cstdint>

namespace throng {

// An application's job system, for DeviceSettings::jobs and AdoptedDevice::jobs. Called from whatever threads call
// throng, even by several at the same time.
class JobSystem {
public:
    virtual ~JobSystem() = default;
    // How many jobs are worth making: as many as can run side by side, the calling thread included; at least 1.
    virtual uint32_t concurrency() const = 0;
    // Calls job(context, 0) to job(context, count - 1), each once, on any threads and in any order, and returns when
    // all have returned. What they compute does not depend on which thread runs which. Jobs wait for nothing and throw
    // nothing. run() should not throw either: that leaves an update half done. It must not throw while a job runs or
    // may still be run.
    virtual void run(uint32_t count, void (*job)(void* context, uint32_t index), void* context) = 0;
};

}  // namespace throng
