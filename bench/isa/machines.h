// GPUs as their data sheets have them: what of a kernel fits them at once, and how fast they issue and move.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace throng::bench {

// A SIMD unit (on NVIDIA's GPUs a quarter of a multiprocessor), and its part of what it shares with others.
struct Simd {
    std::string_view family;  // as RADV_FORCE_FAMILY takes it; of NVIDIA the architecture
    uint32_t lanes = 32;      // that it computes a clock
    uint32_t smallest_subgroup = 32, largest_subgroup = 64;
    uint32_t subgroups = 0;            // that it holds at most
    uint32_t register_bytes = 0;       // of vector registers
    uint32_t register_step_bytes = 0;  // what a subgroup takes of them is a multiple of that
    uint32_t shared_simds = 4;         // that have shared memory together
    uint32_t shared_bytes = 0;         // of all these
    uint32_t shared_step_bytes = 0;    // what a workgroup takes of it is a multiple of that
};

// The families of AMD's GPUs that `throng bench isa` compiles for.
std::span<const Simd> compiled_families();
// Null where there is none of this name.
const Simd* find_family(std::string_view name);

// A device that times are predicted for.
struct Machine {
    std::string_view name;
    const Simd* simd = nullptr;
    std::string_view code;  // family whose machine code stands for its own
    uint32_t simd_count = 0;
    double clock_ghz = 0;     // boost
    double bytes_per_ns = 0;  // of memory: GB/s
};

std::span<const Machine> machines();

// What a kernel takes, as far as it decides how many of its subgroups a SIMD holds.
struct KernelNeeds {
    uint32_t subgroup_size = 0, workgroup_size = 0, vgprs = 0, shared_bytes = 0;
};

double subgroups_of(const KernelNeeds& kernel);  // of a workgroup

struct Occupancy {
    double subgroups = 0;    // that a SIMD holds, on average over those that share shared memory
    std::string_view limit;  // "registers", "shared memory", or "places" where neither is
};

Occupancy occupancy_of(const KernelNeeds& kernel, const Simd& simd);

}  // namespace throng::bench
