// The methods of the Hierarchy-Scan: one row each. Tests, benchmark and command line loop over this table.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace throng {

// How a method spreads over the GPU.
enum class ScanSpread {
    kWorkgroupPerInstance,   // joints in strides over the workgroup
    kInvocationPerInstance,
};

// What a device offers that a method may need.
struct ScanLimits {
    uint32_t shared_memory_bytes = 0;
    uint32_t workgroup_size = 0;  // largest
};

// Workgroup size and specialization constants (constant_id 1, 2, …) for a skeleton of `joint_count` joints.
struct ScanShape {
    uint32_t workgroup_size = 0;
    std::vector<uint32_t> constants;
};

struct ScanMethod {
    std::string_view name;
    std::string_view summary;
    std::string_view source;
    std::span<const uint32_t> spirv;
    ScanSpread spread;
    bool uses_scratch;  // for skeletons that its shape cannot hold on the chip
    std::vector<uint32_t> (*links)(std::span<const uint32_t> parents);
    ScanShape (*shape)(uint32_t joint_count, const ScanLimits& limits);
};

std::span<const ScanMethod> scan_table();

// The row with this name, or null.
const ScanMethod* find_scan_method(std::string_view name);

}  // namespace throng
