#include "blend/layered.h"

#include "gpu/barrier.h"

#include <algorithm>

namespace throng {
namespace {

constexpr uint32_t kPlain[] = {
#include "blend/layered.comp.inc"
};
constexpr uint32_t kWide[] = {
#include "blend/layered.wide.inc"
};

constexpr uint32_t kInOrderPlain[] = {
#include "blend/layered_in_order.comp.inc"
};
constexpr uint32_t kInOrderWide[] = {
#include "blend/layered_in_order.wide.inc"
};

static_assert(sizeof(io::Voice) == 32, "two rows of a table");

}  // namespace

Kernel layered_kernel(const std::shared_ptr<Gpu>& gpu, const LayeredSettings& settings) {
    const std::span<const uint32_t> plain = settings.in_order ? std::span<const uint32_t>(kInOrderPlain) : kPlain,
                                    wide = settings.in_order ? std::span<const uint32_t>(kInOrderWide) : kWide;
    return Kernel(gpu, {.name = "layered",
                        .spirv = gpu->prefers_wide_words() ? wide : plain,
                        .constants = {settings.packed, settings.output == BlendOutput::kSimilarity, settings.inertial,
                                      settings.posed}});
}

void record_layered_in_order(const Gpu& gpu, VkCommandBuffer commands, const Kernel& kernel, const Bindings& bindings,
                             io::LayeredInOrderPush push, uint32_t loop_iterations) {
    // Two rounds for each additive voice, and the ends of both loops
    const uint32_t of_joint = 2 * push.voice_limit + 3;
    const uint32_t joints = std::max((loop_iterations - 1) / of_joint, 1u);
    for (push.first_joint = 0; push.first_joint < push.joint_count; push.first_joint = push.joint_end) {
        if (push.first_joint > 0) memory_barrier(gpu, commands, kShaderRead | kShaderWrite, kShaderRead | kShaderWrite);
        push.joint_end = push.first_joint + std::min(joints, push.joint_count - push.first_joint);
        kernel.dispatch_invocations(commands, bindings, push, push.instance_count);
    }
}

}  // namespace throng
