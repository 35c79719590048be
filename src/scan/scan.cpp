#include "scan/scan.h"

#include <algorithm>

namespace throng {

ScanStage::ScanStage(const std::shared_ptr<Gpu>& gpu, const ScanMethod& method, std::span<const uint32_t> parents)
    : method_(&method), joint_count_(static_cast<uint32_t>(parents.size())), links_(upload(gpu, "scan links", method.links(parents))) {
    const auto& limits = gpu->properties.limits;
    const ScanShape shape = method.shape(joint_count_, {.shared_memory_bytes = limits.maxComputeSharedMemorySize,
                                                        .workgroup_size = std::min(limits.maxComputeWorkGroupSize[0], limits.maxComputeWorkGroupInvocations)});
    kernel_ = Kernel(gpu, {.name = method.name, .spirv = method.spirv, .workgroup_size = shape.workgroup_size, .constants = shape.constants});
}

Bindings ScanStage::bind(const ScanBuffers& buffers) const {
    return kernel_.bind(buffers);
}

void ScanStage::record(VkCommandBuffer commands, const Bindings& bindings, uint32_t instance_count) const {
    const io::ScanPush push{joint_count_, instance_count};
    if (method_->spread == ScanSpread::kWorkgroupPerInstance) kernel_.dispatch_workgroups(commands, bindings, push, instance_count);
    else kernel_.dispatch_invocations(commands, bindings, push, instance_count);
}

}  // namespace throng
