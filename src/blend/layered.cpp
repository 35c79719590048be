#include "blend/layered.h"

#include "blend/layered.kernel.h"
#include "blend/layered_in_order.kernel.h"
#include "gpu/barrier.h"

#include <algorithm>

namespace throng {
namespace {

static_assert(sizeof(io::ActiveClip) == 32, "two rows of a table");

}  // namespace

Kernel layered_kernel(const std::shared_ptr<Gpu>& gpu, const LayeredSettings& settings) {
    const KernelCode& code = settings.in_order ? kernels::layered_in_order : kernels::layered;
    return code.on(gpu, {settings.packed, settings.output == BlendOutput::kSimilarity, settings.inertial,
                         settings.pose_overrides, settings.varies});
}

void record_layered_in_order(const Gpu& gpu, VkCommandBuffer commands, const Kernel& kernel, const Bindings& bindings,
                             io::LayeredInOrderPush push, uint32_t loop_iterations) {
    // At most two iterations for each active clip, and the tests that end both loops
    const uint32_t of_joint = 2 * push.active_clip_limit + 3;
    const uint32_t joints = std::max((loop_iterations - 1) / of_joint, 1u);
    for (push.first_joint = 0; push.first_joint < push.joint_count; push.first_joint = push.joint_end) {
        if (push.first_joint > 0) memory_barrier(gpu, commands, kShaderRead | kShaderWrite, kShaderRead | kShaderWrite);
        push.joint_end = push.first_joint + std::min(joints, push.joint_count - push.first_joint);
        kernel.dispatch_invocations(commands, bindings, push, push.instance_count);
    }
}

}  // namespace throng
