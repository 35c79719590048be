// The bind stage: model transforms -> skin matrices.
#pragma once

#include "bind/bind_io.h"
#include "gpu/kernel.h"

#include <throng/crowd.h>

namespace throng {

// In the order of the bindings; dispatched with io::BindPush, a workgroup per instance.
struct BindBuffers {
    BufferRange model;            // Affine[instance_count][joint_count], model_from_joint
    BufferRange palette_joints;   // uint[palette_count]; this and the next are tables (gpu/table.glsl)
    BufferRange joint_from_bind;  // Affine[palette_count]
    BufferRange skin;             // [instance_count][palette_count] in the format, model_from_bind, written
};

Kernel bind_kernel(const std::shared_ptr<Gpu>& gpu, SkinFormat format);

}  // namespace throng
