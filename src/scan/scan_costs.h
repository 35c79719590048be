// What the planner knows of a device: the constants of its cost model (scan/scan_planner.h). `throng tune` measures
// them once for a device and keeps them in the user's cache folder; without that there are built-in ones for each
// family of devices.
#pragma once

#include "gpu/gpu.h"

#include <filesystem>
#include <string>

namespace throng {

struct ScanCosts {
    double launch_ms = 0;           // of a dispatch, whatever it does
    double row_ns = 0;              // a subgroup loads or stores 16 bytes an invocation
    double scattered_rows = 1;      // the factor on that if the rows of its threads lie far apart
    double multiplication_ns = 0;   // a subgroup multiplies two transforms
    double barrier_ns = 0;          // a subgroup waits at a barrier
    double workgroup_ns = 0;        // a workgroup starts and ends
    double latency_ns = 0;          // a row waits for one that it depends on, with nothing else to run
    double units = 1;               // workgroups that run side by side at full speed: cores, SIMD units
    double resident_subgroups = 1;  // subgroups that are in flight at once
    double bytes_per_ns = 1;        // of memory, read and written
    std::string origin;             // where these come from, for people
};

// The measured ones where a readable file is in the cache, else the built-in ones.
ScanCosts scan_costs(const Gpu& gpu);
ScanCosts built_in_scan_costs(const Gpu& gpu);
// Of GPUs. `vendor_id`: as VkPhysicalDeviceProperties has it.
ScanCosts built_in_hardware_costs(uint32_t vendor_id);

// $XDG_CACHE_HOME/throng, or ~/.cache/throng; a file for each device and driver. Empty where neither variable is set.
std::filesystem::path scan_costs_file(const Gpu& gpu);
std::string to_json(const ScanCosts& costs);
// Throws kInvalidFile where the text is not such an object with positive, finite numbers.
ScanCosts scan_costs_from_json(std::string_view text, const std::string& place);

}  // namespace throng
