// The cull stage: placements and a view -> the list of what is drawn, level of detail by level, the work of animating
// it, and the commands that do both without the CPU.
#pragma once

#include "cull/cull_io.h"
#include "gpu/kernel.h"

namespace throng {

// The number of cells of consecutive instances; how many cells a workgroup processes; and how many workgroups that
// takes.
uint32_t cell_count(uint32_t instance_count);
uint32_t cells_of_workgroup(uint32_t instance_count);
uint32_t cull_workgroups_of(uint32_t instance_count);

// Dispatched one after the other, with a barrier between: cull with io::CullPush, or reveal with io::RevealPush, a
// workgroup for every `cells_of_workgroup` cells; offsets with io::OffsetsPush, one workgroup; list with io::CullPush,
// like cull. cells comes before cull, with io::CullPush, an invocation per cell. pyramid comes before
// reveal, for each level: io::PyramidPush, an invocation for each texel that it writes, or fewer.
struct CullKernels {
    explicit CullKernels(const std::shared_ptr<Gpu>& gpu);

    Kernel cells, cull, offsets, list;
    Kernel reveal, pyramid;  // none on a native device, which has no depths
};

}  // namespace throng
