#include "scan/scan.h"

#include "base/failure.h"
#include "scan/scan_shaders.h"

#include <algorithm>

namespace throng {
namespace {

constexpr uint32_t kLlvmpipeLoopIterations = 65535;  // Mesa, gallivm/lp_bld_limits.h: "shared between every loop"

}  // namespace

ScanLimits scan_limits(const Gpu& gpu) {
    const auto& limits = gpu.properties.limits;
    return {.shared_memory_bytes = limits.maxComputeSharedMemorySize,
            .workgroup_size = std::min(limits.maxComputeWorkGroupSize[0], limits.maxComputeWorkGroupInvocations),
            .subgroup_size = gpu.smallest_subgroup,
            .largest_subgroup_size = gpu.can_choose_subgroup || gpu.smallest_subgroup == gpu.largest_subgroup
                                         ? gpu.largest_subgroup
                                         : 0,
            .shuffle = gpu.has_shuffle,
            .is_cpu = gpu.is_cpu(),
            .loop_iterations = gpu.is_cpu() ? kLlvmpipeLoopIterations : 0xFFFFFFFF,
            .storage_buffers = limits.maxPerStageDescriptorStorageBuffers};
}

ScanStage::ScanStage(Uploads& uploads, const ScanChoice& choice, const ScanRig& rig, const ScanLimits& limits,
                     bool varies)
    : choice_(choice), joint_count_(rig.joint_count()) {
    const ScanMethod& method = *choice.method;
    ScanPlan plan = plan_scan(method, rig, limits, choice.threads);
    if (!plan.unsupported_reason.empty())
        throw Failure(ErrorCode::kUnsupported, "scan method '" + std::string(method.name) + "'",
                      plan.unsupported_reason);
    counts_ = plan.counts;
    workgroup_size_ = plan.workgroup_size;
    instances_per_workgroup_ = plan.instances_per_workgroup;
    links_ = upload(uploads, "scan links", plan.links);
    const ScanShaders& shaders = scan_shaders(method.name);
    if (varies) {
        constexpr size_t kVaryingInstances = 8;  // the number of the constant; the first is 1
        plan.constants.resize(kVaryingInstances - 1);
        plan.constants.push_back(plan.instances_per_workgroup);
    }
    const std::shared_ptr<Gpu>& gpu = uploads.gpu();
    kernel_ = Kernel(gpu, {.name = method.name,
                           .spirv = gpu->uses_software_kernels() ? shaders.software : shaders.plain,
                           .workgroup_size = plan.workgroup_size,
                           .constants = std::move(plan.constants),
                           .subgroup_size = plan.subgroup_size,
                           .full_subgroups = plan.full_subgroups,
                           .native = shaders.native});
}

ScanStage::ScanStage(const std::shared_ptr<Gpu>& gpu, const ScanChoice& choice, const ScanRig& rig,
                     const ScanLimits& limits) {
    Uploads uploads(gpu);
    *this = ScanStage(uploads, choice, rig, limits);
    uploads.finish();
}

void ScanStage::record(VkCommandBuffer commands, const Bindings& bindings, uint32_t instance_count) const {
    kernel_.dispatch_workgroups(commands, bindings, io::ScanPush{joint_count_, instance_count, 1},
                                (instance_count + instances_per_workgroup_ - 1) / instances_per_workgroup_);
}

}  // namespace throng
