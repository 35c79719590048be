// A lower bound of a kernel's time on a device, from its machine code: a prediction, not a measurement.
#pragma once

#include "bench/isa/machine_code.h"
#include "bench/isa/machines.h"
#include "scan/scan_counts.h"

#include <optional>
#include <span>
#include <string>

namespace throng::bench {

// How often a subgroup runs each loop of the machine code, summed over all entries to it; nothing if the code has loops
// other than those whose trips are given and those over its lanes.
std::optional<std::vector<LoopTrips>> trips_of(const MachineCode& code, std::span<const LoopTrips> known,
                                               uint32_t subgroup_size);

// What a subgroup issues, including code that branches may skip. `trips`: of each loop.
InstructionCounts issued_by_subgroup(const MachineCode& code, std::span<const LoopTrips> trips);

// One dispatch of a kernel.
struct KernelWork {
    KernelNeeds needs;
    InstructionCounts issued;  // by a subgroup
    double subgroups = 0;      // in all
    double bytes = 0;          // to and from memory
};

struct Prediction {
    double issue_ms = 0;    // each SIMD issues an instruction a clock
    double latency_ms = 0;  // a subgroup waits for its loads while as many others as fit the SIMD do their work
    double memory_ms = 0;   // at the memory's full rate
    Occupancy occupancy;

    double ms() const;  // the longest of the three
    std::string limit() const;
};

// How long a subgroup takes that has a SIMD to itself: instructions, and waiting for loads between them.
struct SubgroupTime {
    double issue_ns = 0, wait_ns = 0;
};

SubgroupTime subgroup_time(const KernelWork& work, const Machine& machine);
Prediction predict(const KernelWork& work, const Machine& machine);

}  // namespace throng::bench
