// The layered stage: the active clips of each instance -> its local transforms; sample and blend in one, for characters
// that play in layers.
#pragma once

#include "blend/blend.h"
#include "blend/layered_io.h"
#include "control/controller_io.h"

#include <compare>

namespace throng {

// Dispatched with io::LayeredPush, a workgroup per instance. The buffers that it only reads are tables
// (gpu/table.glsl), except kInertiasBuffer; kActiveClipsBuffer, which a kernel writes, is made by make_table().
struct LayeredSettings {
    bool packed = false;  // Character::packed
    BlendOutput output = BlendOutput::kAffine;
    bool inertial = false;
    bool pose_overrides = false;  // poses may be set
    // Layers blend rotations in model space: an invocation per instance, by record_layered_in_order()
    bool in_order = false;

    friend auto operator<=>(const LayeredSettings&, const LayeredSettings&) = default;
};
Kernel layered_kernel(const std::shared_ptr<Gpu>& gpu, const LayeredSettings& settings);

// All joints, in as few dispatches as loops of `loop_iterations` (ScanLimits) allow, with barriers between them.
void record_layered_in_order(const Gpu& gpu, VkCommandBuffer commands, const Kernel& kernel, const Bindings& bindings,
                             io::LayeredInOrderPush push, uint32_t loop_iterations);

}  // namespace throng
