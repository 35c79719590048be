// The work that the scan methods give to GPUs, from their machine code.
#pragma once

#include "bench/isa/compiler.h"
#include "bench/isa/prediction.h"
#include "scan/scan_planner.h"

#include <functional>

namespace throng::bench {

enum class ScanPlace {
    kMemory,  // the stage: local and model transforms lie in memory
    kChip,    // local transforms lie in shared memory, and nothing is stored: scan/on_chip.glsl, one repeat
};

// One choice for one skeleton, compiled.
struct ScanWork {
    ScanPlace place = ScanPlace::kMemory;
    ScanChoice choice;
    ScanPlan plan;
    uint32_t joint_count = 0;
    Executable kernel;
    std::vector<LoopTrips> trips;

    KernelWork of(uint32_t characters) const;
};

// Calls `visit` with each choice of each method that applies. Throws kUnsupported if the machine code has other loops
// than the plan.
void visit_scan_works(const Compiler& compiler, const ScanRig& rig, ScanPlace place,
                      const std::function<void(const ScanWork&)>& visit);

}  // namespace throng::bench
