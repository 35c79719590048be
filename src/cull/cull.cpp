#include "cull/cull.h"

#include "cull/cull.kernel.h"
#include "cull/list.kernel.h"
#include "cull/offsets.kernel.h"
#include "cull/pyramid.kernel.h"
#include "cull/reveal.kernel.h"

namespace throng {

CullKernels::CullKernels(const std::shared_ptr<Gpu>& gpu)
    : cull(kernels::cull.on(gpu)), offsets(kernels::offsets.on(gpu)), list(kernels::list.on(gpu)) {
    if (gpu->is_native()) return;
    reveal = kernels::reveal.on(gpu);
    pyramid = kernels::pyramid.on(gpu);
}

}  // namespace throng
