// The pace stage: skin matrices between two updates of an instance that is not animated in all of them.
#pragma once

#include "gpu/kernel.h"
#include "pace/pace_io.h"

#include <throng/crowd.h>

namespace throng {

// In the order of the bindings.
struct PaceBuffers {
    BufferRange work;      // a table of words (cull/cull_io.h)
    BufferRange states;    // uint[instance_count], kept by the cull stage
    BufferRange previous;  // skin matrices, a table of rows
    BufferRange ahead;     // likewise
    BufferRange current;   // written; may be `previous`
    BufferRange entries;   // a table of uint[palette_count]: palette entries, those of coarser sets of joints first
};

// Dispatched with io::PacePush, a workgroup for each instance of the section.
Kernel pace_kernel(const std::shared_ptr<Gpu>& gpu, SkinFormat format);

}  // namespace throng
