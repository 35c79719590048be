#include "bench/isa/prediction.h"

#include <algorithm>
#include <cmath>

namespace throng::bench {
namespace {

// Assumed for all devices, in clocks: how long a subgroup waits for loads that hit the second-level cache, and for
// shared memory, the scalar cache or a barrier.
constexpr double kMemoryWait = 300, kSharedWait = 60;
constexpr double kTranscendentalRate = 4;  // clocks, where other arithmetic takes one

// Clocks to issue all instructions of a subgroup, one at a time.
double issue_clocks(const InstructionCounts& issued, uint32_t subgroup_size, const Simd& simd) {
    using enum InstructionClass;
    const double passes = std::max(1.0, static_cast<double>(subgroup_size) / simd.lanes);
    return passes * (issued[kVector] + kTranscendentalRate * issued[kTranscendental]) + issued[kShared] +
           issued[kLoad] + issued[kStore] + issued[kScalar];
}

}  // namespace

std::optional<std::vector<LoopTrips>> trips_of(const MachineCode& code, std::span<const LoopTrips> known,
                                               uint32_t subgroup_size) {
    std::vector<LoopTrips> trips;
    std::vector<double> around{1};  // trips of the loops around the next one, by their depth
    for (const MachineLoop& loop : code.loops) {
        around.resize(loop.depth + 1);
        if (loop.over_lanes) {
            trips.push_back({"lanes", around.back() * subgroup_size});
        } else {
            if (known.empty()) return std::nullopt;
            trips.push_back(known.front());
            known = known.subspan(1);
        }
        around.push_back(trips.back().trips);
    }
    if (!known.empty()) return std::nullopt;
    return trips;
}

InstructionCounts issued_by_subgroup(const MachineCode& code, std::span<const LoopTrips> trips) {
    InstructionCounts issued = code.outside;
    for (size_t i = 0; i < trips.size(); ++i) issued.add(code.loops[i].own, trips[i].trips);
    return issued;
}

double Prediction::ms() const { return std::max({issue_ms, latency_ms, memory_ms}); }

std::string Prediction::limit() const {
    if (ms() == memory_ms) return "memory";
    if (ms() == issue_ms) return "instructions";
    return "waiting for loads";
}

SubgroupTime subgroup_time(const KernelWork& work, const Machine& machine) {
    const double waits = kMemoryWait * work.issued[InstructionClass::kMemoryWait] +
                         kSharedWait * work.issued[InstructionClass::kSharedWait];
    return {issue_clocks(work.issued, work.needs.subgroup_size, *machine.simd) / machine.clock_ghz,
            waits / machine.clock_ghz};
}

Prediction predict(const KernelWork& work, const Machine& machine) {
    constexpr double kMs_per_ns = 1e-6;
    const Occupancy occupancy = occupancy_of(work.needs, *machine.simd);
    const SubgroupTime alone = subgroup_time(work, machine);
    const double subgroups_of_simd = std::max(1.0, work.subgroups / machine.simd_count);
    return {.issue_ms = subgroups_of_simd * alone.issue_ns * kMs_per_ns,
            .latency_ms = std::max(1.0, subgroups_of_simd / occupancy.subgroups) * (alone.issue_ns + alone.wait_ns) *
                          kMs_per_ns,
            .memory_ms = work.bytes / machine.bytes_per_ns * kMs_per_ns,
            .occupancy = occupancy};
}

}  // namespace throng::bench
