#include "bench/isa/machines.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace throng::bench {
namespace {

constexpr uint32_t kKiB = 1024, kRegister_bytes = 4;

// AMD: the manuals "RDNA 2", "RDNA 3" and "Vega" "Instruction Set Architecture", and Mesa 22.3, ac_gpu_info.c. A
// workgroup on RDNA uses the two compute units, with four SIMDs, of a workgroup processor. In the order of the fields:
// family, lanes, smallest and largest subgroup, subgroup slots, bytes of registers and their granularity, SIMDs that
// share memory, bytes of that memory and their granularity.
constexpr std::array kFamilies{
    Simd{"vega10", 16, 64, 64, 10, 64 * kKiB, 1 * kKiB, 4, 64 * kKiB, 512},
    Simd{"navi10", 32, 32, 64, 20, 128 * kKiB, 1 * kKiB, 4, 128 * kKiB, 512},
    Simd{"navi21", 32, 32, 64, 16, 128 * kKiB, 2 * kKiB, 4, 128 * kKiB, 1 * kKiB},
    Simd{"vangogh", 32, 32, 64, 16, 128 * kKiB, 2 * kKiB, 4, 128 * kKiB, 1 * kKiB},
    Simd{"gfx1100", 32, 32, 64, 16, 192 * kKiB, 3 * kKiB, 4, 128 * kKiB, 1 * kKiB},
};
// Integrated RDNA 3 has the smaller register file.
constexpr Simd kGfx1103{"gfx1103", 32, 32, 64, 16, 128 * kKiB, 2 * kKiB, 4, 128 * kKiB, 1 * kKiB};
// NVIDIA: "CUDA C++ Programming Guide", compute capabilities 8.6 and 9.0.
constexpr Simd kAmpere{"ga102", 32, 32, 32, 12, 64 * kKiB, 1 * kKiB, 4, 100 * kKiB, 128},
    kHopper{"gh100", 32, 32, 32, 16, 64 * kKiB, 1 * kKiB, 4, 228 * kKiB, 128};

// Compute units, boost clocks and bandwidths from the makers' product pages; the integrated GPU with DDR5-5600 on two
// channels.
constexpr std::array kMachines{
    Machine{"RTX 3080", &kAmpere, "navi21", 68 * 4, 1.71, 760},
    Machine{"RX 6900 XT", &kFamilies[2], "navi21", 80 * 2, 2.25, 512},
    Machine{"RX 7900 XTX", &kFamilies[4], "gfx1100", 96 * 2, 2.5, 960},
    Machine{"H100 SXM", &kHopper, "navi21", 132 * 4, 1.98, 3350},
    Machine{"Steam Deck", &kFamilies[3], "navi21", 8 * 2, 1.6, 88},
    Machine{"Radeon 780M", &kGfx1103, "gfx1100", 12 * 2, 2.7, 89.6},
};

uint32_t rounded_up(uint32_t value, uint32_t step) { return (value + step - 1) / step * step; }

}  // namespace

std::span<const Simd> compiled_families() { return kFamilies; }

const Simd* find_family(std::string_view name) {
    const auto found = std::ranges::find(kFamilies, name, &Simd::family);
    return found == kFamilies.end() ? nullptr : &*found;
}

std::span<const Machine> machines() { return kMachines; }

double subgroups_of(const KernelNeeds& kernel) {
    return std::max(1.0, std::ceil(static_cast<double>(kernel.workgroup_size) / kernel.subgroup_size));
}

Occupancy occupancy_of(const KernelNeeds& kernel, const Simd& simd) {
    Occupancy occupancy{static_cast<double>(simd.subgroups), "places"};
    const auto limit = [&](double subgroups, std::string_view by) {
        if (subgroups < occupancy.subgroups) occupancy = {subgroups, by};
    };
    const uint32_t register_bytes = kernel.vgprs * kernel.subgroup_size * kRegister_bytes;
    if (register_bytes > 0)
        limit(simd.register_bytes / rounded_up(register_bytes, simd.register_step_bytes), "registers");
    if (kernel.shared_bytes == 0) return occupancy;
    const double workgroups = simd.shared_bytes / rounded_up(kernel.shared_bytes, simd.shared_step_bytes),
                 subgroups = subgroups_of(kernel);
    limit(workgroups * subgroups / simd.shared_simds, "shared memory");
    return occupancy;
}

}  // namespace throng::bench
