// The cull stage: placements and a view -> the list of what is drawn, level of detail by level, the work of animating
// it, and the commands that do both without the CPU.
#pragma once

#include "cull/cull_io.h"
#include "gpu/kernel.h"

namespace throng {

// Dispatched one after the other, with a barrier between: cull with io::CullPush, or reveal with io::RevealPush, an
// invocation per instance; offsets with io::OffsetsPush, one workgroup; list with io::CullPush. pyramid comes before
// reveal, for each level: io::PyramidPush, an invocation for each texel that it writes, or fewer.
struct CullKernels {
    explicit CullKernels(const std::shared_ptr<Gpu>& gpu);

    Kernel cull, offsets, list;
    Kernel reveal, pyramid;  // none on a native device, which has no depths
};

}  // namespace throng
