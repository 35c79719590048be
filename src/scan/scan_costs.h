// The constants of the planner's cost model (scan/scan_planner.h) for a device. `throng tune` measures them once per
// device and stores them in the user's cache folder. Without that, built-in ones for each family of devices are used.
#pragma once

#include "gpu/gpu.h"

#include <filesystem>
#include <string>

namespace throng {

struct ScanCosts {
    double launch_ms = 0;           // fixed cost of a dispatch
    double row_ns = 0;              // a subgroup loads or stores 16 bytes an invocation
    double scattered_rows = 1;      // factor on row_ns if the rows of the lanes lie far apart
    double multiplication_ns = 0;   // a subgroup multiplies two transforms
    double barrier_ns = 0;          // a subgroup waits at a barrier
    double workgroup_ns = 0;        // a workgroup starts and ends
    double latency_ns = 0;          // a row waits for one that it depends on, while nothing else can run
    double units = 1;               // workgroups that run in parallel at full speed: cores or SIMD units
    double resident_subgroups = 1;  // subgroups that are resident at once
    double bytes_per_ns = 1;        // memory bandwidth, reads plus writes
    std::string origin;             // where these costs come from, for messages
};

// The measured costs if the cache folder has a readable file, else the built-in ones.
ScanCosts scan_costs(const Gpu& gpu);
ScanCosts built_in_scan_costs(const Gpu& gpu);
// For GPUs. `vendor_id`: VkPhysicalDeviceProperties::vendorID.
ScanCosts built_in_hardware_costs(uint32_t vendor_id);

// A file in cache_folder() for each device and driver. Empty if there is no cache folder.
std::filesystem::path scan_costs_file(const Gpu& gpu);
std::string to_json(const ScanCosts& costs);
// Throws kInvalidFile if the text is not an object as to_json() writes it, with positive, finite numbers.
ScanCosts scan_costs_from_json(std::string_view text, const std::string& place);

}  // namespace throng
