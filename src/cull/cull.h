// The cull stage: placements and a view -> the list of what is drawn, level of detail by level, and the commands that animate and draw it without the CPU.
#pragma once

#include "cull/cull_io.h"
#include "gpu/kernel.h"

namespace throng {

// Each in the order of the bindings.
struct CullBuffers {
    BufferRange view;        // io::CullView
    BufferRange placements;  // Affine[instance_count], world_from_model
    BufferRange details;     // uint[instance_count], written
    BufferRange counts;      // uint4[workgroups], written
};
struct OffsetsBuffers {
    BufferRange counts;
    BufferRange list;      // uint[io::kFirstListed + instance_count]
    BufferRange dispatch;  // VkDispatchIndirectCommand, of the kernel that animates the list
    BufferRange draws;     // io::DrawCommand[section_count][kDetailLevels], of which the number of instances is written
};
struct ListBuffers {
    BufferRange details, offsets, list;
};

// Dispatched one after the other, with a barrier between: io::CullPush, an invocation per instance; io::OffsetsPush, one workgroup; io::CullPush again.
struct CullKernels {
    explicit CullKernels(const std::shared_ptr<Gpu>& gpu);

    Kernel cull, offsets, list;
};

}  // namespace throng
