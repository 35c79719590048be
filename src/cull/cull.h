// The cull stage: placements and a view -> the list of what is drawn, level of detail by level, the work of animating
// it, and the commands that do both without the CPU.
#pragma once

#include "cull/cull_io.h"
#include "gpu/kernel.h"

namespace throng {

// Each in the order of the bindings.
struct CullBuffers {
    BufferRange view;        // io::CullView, a table
    BufferRange placements;  // Affine[instance_count], world_from_model; likewise
    BufferRange states;      // uint[instance_count], read and written
    BufferRange verdicts;    // uint[instance_count], written
    BufferRange counts;      // uint[workgroups][kCounters], written
};
struct RevealBuffers {
    CullBuffers cull;     // verdicts are also read
    BufferRange pyramid;  // float[]
};
struct PyramidBuffers {
    BufferRange fine, coarse;  // float[]
};
struct OffsetsBuffers {
    BufferRange counts;
    BufferRange list;  // uint[io::kFirstListed + instance_count]
    BufferRange work;  // uint[io::kFirstWork + io::kMostWorkOfInstance * instance_count]
    // VkDispatchIndirectCommand[io::kWorkSections + 1], of the kernels that work through the sections, and of a
    // workgroup for each that is drawn
    BufferRange dispatches;
    // io::DrawCommand[section_count][kDetailLevels], of which the number of instances is written
    BufferRange draws;
};
struct ListBuffers {
    BufferRange verdicts, offsets, list, work;
};

// Dispatched one after the other, with a barrier between: cull with io::CullPush, or reveal with io::RevealPush, an
// invocation per instance; offsets with io::OffsetsPush, one workgroup; list with io::CullPush. pyramid comes before
// reveal, for each level: io::PyramidPush, an invocation for each texel that it writes, or fewer.
struct CullKernels {
    explicit CullKernels(const std::shared_ptr<Gpu>& gpu);

    Kernel cull, offsets, list, reveal, pyramid;
};

}  // namespace throng
