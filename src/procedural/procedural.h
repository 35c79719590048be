// The procedural stage: local transforms of chosen joints -> the same joints, moved by rules (docs/procedural.md).
#pragma once

#include "gpu/kernel.h"
#include "procedural/procedural_io.h"

namespace throng {

// The kernel for chains of one kind. Dispatched with io::ProceduralPush, push.workgroups workgroups for each chain.
Kernel procedural_kernel(const std::shared_ptr<Gpu>& gpu, uint32_t kind, bool similarities);

}  // namespace throng
