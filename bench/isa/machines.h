// GPUs as their data sheets describe them: how much of a kernel fits at once, and how fast they issue instructions and
// move data.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace throng::bench {

// A SIMD unit (on NVIDIA's GPUs a quarter of a multiprocessor), and what it shares with others.
struct Simd {
    std::string_view family;  // a name for RADV_FORCE_FAMILY; for NVIDIA the chip
    uint32_t lanes = 32;      // that it computes in a clock
    uint32_t smallest_subgroup = 32, largest_subgroup = 64;
    uint32_t subgroups = 0;            // that it holds at most
    uint32_t register_bytes = 0;       // of vector registers
    uint32_t register_step_bytes = 0;  // a subgroup takes a multiple of this
    uint32_t shared_simds = 4;         // SIMDs that share one shared memory
    uint32_t shared_bytes = 0;         // of that memory
    uint32_t shared_step_bytes = 0;    // a workgroup takes a multiple of this
};

// The families of AMD's GPUs that `throng bench isa` compiles for.
std::span<const Simd> compiled_families();
// Null where there is none of this name.
const Simd* find_family(std::string_view name);

// A device that times are predicted for.
struct Machine {
    std::string_view name;
    const Simd* simd = nullptr;
    std::string_view code;  // the family whose machine code is used in place of its own
    uint32_t simd_count = 0;
    double clock_ghz = 0;     // boost
    double bytes_per_ns = 0;  // of memory: GB/s
};

std::span<const Machine> machines();

// The resources of a kernel that decide how many of its subgroups a SIMD holds.
struct KernelNeeds {
    uint32_t subgroup_size = 0, workgroup_size = 0, vgprs = 0, shared_bytes = 0;
};

double subgroups_of(const KernelNeeds& kernel);  // of a workgroup

struct Occupancy {
    double subgroups = 0;    // that a SIMD holds, on average over those that share shared memory
    std::string_view limit;  // "registers", "shared memory", or "places" (Simd::subgroups) where neither limits
};

Occupancy occupancy_of(const KernelNeeds& kernel, const Simd& simd);

}  // namespace throng::bench
