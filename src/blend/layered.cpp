#include "blend/layered.h"

#include "gpu/barrier.h"

#include <algorithm>

namespace throng {
namespace {

constexpr uint32_t kPlain[] = {
#include "blend/layered.comp.inc"
};
constexpr uint32_t kSoftware[] = {
#include "blend/layered.software.inc"
};

constexpr uint32_t kInOrderPlain[] = {
#include "blend/layered_in_order.comp.inc"
};
constexpr uint32_t kInOrderSoftware[] = {
#include "blend/layered_in_order.software.inc"
};

static_assert(sizeof(io::ActiveClip) == 32, "two rows of a table");

}  // namespace

Kernel layered_kernel(const std::shared_ptr<Gpu>& gpu, const LayeredSettings& settings) {
    const std::span<const uint32_t> plain = settings.in_order ? std::span<const uint32_t>(kInOrderPlain) : kPlain,
                                    software = settings.in_order ? std::span<const uint32_t>(kInOrderSoftware)
                                                                 : kSoftware;
    return Kernel(gpu, {.name = "layered",
                        .spirv = gpu->uses_software_kernels() ? software : plain,
                        .constants = {settings.packed, settings.output == BlendOutput::kSimilarity, settings.inertial,
                                      settings.pose_overrides}});
}

void record_layered_in_order(const Gpu& gpu, VkCommandBuffer commands, const Kernel& kernel, const Bindings& bindings,
                             io::LayeredInOrderPush push, uint32_t loop_iterations) {
    // Two rounds for each additive active clip, and the ends of both loops
    const uint32_t of_joint = 2 * push.active_clip_limit + 3;
    const uint32_t joints = std::max((loop_iterations - 1) / of_joint, 1u);
    for (push.first_joint = 0; push.first_joint < push.joint_count; push.first_joint = push.joint_end) {
        if (push.first_joint > 0) memory_barrier(gpu, commands, kShaderRead | kShaderWrite, kShaderRead | kShaderWrite);
        push.joint_end = push.first_joint + std::min(joints, push.joint_count - push.first_joint);
        kernel.dispatch_invocations(commands, bindings, push, push.instance_count);
    }
}

}  // namespace throng
