// The scan methods without memory: local transforms lie in shared memory (scan/on_chip.glsl).
#pragma once

#include "gpu/kernel.h"
#include "scan/scan_table.h"

namespace throng::bench {

// The number of local transforms that a workgroup holds.
uint32_t on_chip_transforms(const ScanPlan& plan, const ScanRig& rig);

// Empty if the method can run on-chip: the local transforms of the workgroup's characters need room in the same shared
// memory.
std::string on_chip_unsupported_reason(const ScanPlan& plan, const ScanMethod& method, const ScanRig& rig,
                                       const ScanLimits& limits);

// `barriers_twice`: to measure what barriers cost.
Kernel on_chip_kernel(const std::shared_ptr<Gpu>& gpu, const ScanMethod& method, const ScanPlan& plan,
                      const ScanRig& rig, bool barriers_twice);

}  // namespace throng::bench
