// The layered stage: the active clips of each instance -> its local transforms. Samples and blends in one pass, for
// characters that play clips in layers.
#pragma once

#include "blend/blend.h"
#include "blend/layered_io.h"
#include "control/controller_io.h"

#include <compare>

namespace throng {

// The layered kernel is dispatched with io::LayeredPush, a workgroup per instance. The buffers that it only reads are
// tables (gpu/table.glsl), except kInertiasBuffer. kActiveClipsBuffer, which a kernel writes, is made by make_table().
struct LayeredSettings {
    bool packed = false;  // Character::packed
    BlendOutput output = BlendOutput::kAffine;
    bool inertial = false;
    bool pose_overrides = false;  // the application may set poses
    bool varies = false;          // as BlendSettings'
    // Layers may blend rotations in model space: one invocation per instance, see record_layered_in_order()
    bool in_order = false;

    friend auto operator<=>(const LayeredSettings&, const LayeredSettings&) = default;
};
Kernel layered_kernel(const std::shared_ptr<Gpu>& gpu, const LayeredSettings& settings);

// Records all joints, in as few dispatches as the device's limit of `loop_iterations` (ScanLimits) allows, with
// barriers between them.
void record_layered_in_order(const Gpu& gpu, VkCommandBuffer commands, const Kernel& kernel, const Bindings& bindings,
                             io::LayeredInOrderPush push, uint32_t loop_iterations);

}  // namespace throng
