#include "bench/on_chip_kernel.h"

#include "bench/on_chip_shaders.h"

namespace throng::bench {
namespace {

constexpr uint32_t kBetweenBarriers_bytes = 16;  // on_chip_between_barriers, and its alignment
constexpr uint32_t kMethodConstants = 7;         // constant_id 1 to 7 are the method's own

}  // namespace

uint32_t on_chip_transforms(const ScanPlan& plan, const ScanRig& rig) {
    return plan.instances_per_workgroup * rig.joint_count();
}

std::string on_chip_unsupported_reason(const ScanPlan& plan, const ScanMethod& method, const ScanRig& rig,
                                       const ScanLimits& limits) {
    if (!plan.unsupported_reason.empty()) return plan.unsupported_reason;
    if (!plan.on_chip) return "its transforms pass through memory";
    const uint64_t needed_bytes = uint64_t{plan.counts.shared_bytes} * plan.instances_per_workgroup +
                                  on_chip_transforms(plan, rig) * bytes_of(method.format) + kBetweenBarriers_bytes;
    return memory_unsupported_reason(needed_bytes, ", including the local transforms,", limits);
}

Kernel on_chip_kernel(const std::shared_ptr<Gpu>& gpu, const ScanMethod& method, const ScanPlan& plan,
                      const ScanRig& rig, bool barriers_twice) {
    const OnChipShaders& shaders = on_chip_shaders(method.name);
    std::vector<uint32_t> constants = plan.constants;
    constants.resize(kMethodConstants);
    constants.insert(constants.end(),
                     {barriers_twice ? 1u : 0u, plan.instances_per_workgroup, on_chip_transforms(plan, rig)});
    return Kernel(gpu, {.name = method.name,
                        .spirv = gpu->uses_software_kernels() ? shaders.software : shaders.plain,
                        .workgroup_size = plan.workgroup_size,
                        .constants = std::move(constants),
                        .subgroup_size = plan.subgroup_size,
                        .full_subgroups = plan.full_subgroups});
}

}  // namespace throng::bench
