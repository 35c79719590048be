#include "scan/scan_table.h"

#include "scan/scan_io.h"

#include <algorithm>
#include <array>

namespace throng {
namespace {

constexpr uint32_t kGateauSpirv[] = {
#include "scan/gateau2012_walk.comp.inc"
};
constexpr uint32_t kCompressedSpirv[] = {
#include "scan/compressed.comp.inc"
};
constexpr uint32_t kSerialSpirv[] = {
#include "scan/serial.comp.inc"
};

std::vector<uint32_t> parent_links(std::span<const uint32_t> parents) { return {parents.begin(), parents.end()}; }

// Three words a joint: parent, 8th ancestor within the joint's block of 64, first ancestor outside the block.
std::vector<uint32_t> block_links(std::span<const uint32_t> parents) {
    constexpr uint32_t kBlock = 64, kStride = 8;
    std::vector<uint32_t> links;
    links.reserve(parents.size() * 3);
    for (uint32_t joint = 0; joint < parents.size(); ++joint) {
        const auto in_block = [&](uint32_t other) { return other != io::kScanNoJoint && other / kBlock == joint / kBlock; };
        uint32_t ancestor = joint, distance = 0, eighth = io::kScanNoJoint;
        while (in_block(ancestor)) {
            if (distance == kStride) eighth = ancestor;
            ancestor = parents[ancestor];
            ++distance;
        }
        links.insert(links.end(), {parents[joint], eighth, ancestor});
    }
    return links;
}

// As many invocations as joints, in steps of 32 (a warp), at most 256: more lower the occupancy of GPUs.
uint32_t workgroup_size_for(uint32_t joint_count, const ScanLimits& limits) {
    constexpr uint32_t kStep = 32, kLargest = 256;
    return std::min(std::clamp((joint_count + kStep - 1) / kStep * kStep, kStep, kLargest), limits.workgroup_size);
}

ScanShape strided_shape(uint32_t joint_count, const ScanLimits& limits) { return {workgroup_size_for(joint_count, limits), {}}; }

ScanShape serial_shape(uint32_t, const ScanLimits& limits) { return {std::min(64u, limits.workgroup_size), {}}; }

// Two matrices a joint in shared memory, or none.
ScanShape compressed_shape(uint32_t joint_count, const ScanLimits& limits) {
    constexpr uint32_t kBytesPerJoint = 96;
    const bool fits = uint64_t{joint_count} * kBytesPerJoint <= limits.shared_memory_bytes;
    return {workgroup_size_for(joint_count, limits), {fits ? joint_count : 1u, fits ? 1u : 0u}};
}

constexpr std::array kMethods{
    ScanMethod{.name = "gateau2012_walk",
               .summary = "one thread per joint walks up to the root",
               .source = "Gateau, Massive Crowds on GPU, GTC 2012 (Algorithm 1)",
               .spirv = kGateauSpirv,
               .spread = ScanSpread::kWorkgroupPerInstance,
               .uses_scratch = false,
               .links = parent_links,
               .shape = strided_shape},
    ScanMethod{.name = "compressed",
               .summary = "blocks of 64 joints, two strides of 8 inside a block, then hops between blocks",
               .source = "the paper's final method (Algorithm 4)",
               .spirv = kCompressedSpirv,
               .spread = ScanSpread::kWorkgroupPerInstance,
               .uses_scratch = true,
               .links = block_links,
               .shape = compressed_shape},
    ScanMethod{.name = "serial",
               .summary = "one thread per character, joints in order",
               .source = "common practice on CPUs",
               .spirv = kSerialSpirv,
               .spread = ScanSpread::kInvocationPerInstance,
               .uses_scratch = false,
               .links = parent_links,
               .shape = serial_shape},
};

}  // namespace

std::span<const ScanMethod> scan_table() { return kMethods; }

const ScanMethod* find_scan_method(std::string_view name) {
    const auto found = std::find_if(kMethods.begin(), kMethods.end(), [&](const ScanMethod& m) { return m.name == name; });
    return found == kMethods.end() ? nullptr : &*found;
}

}  // namespace throng
