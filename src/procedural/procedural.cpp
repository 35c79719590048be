#include "procedural/procedural.h"

#include "procedural/procedural.kernel.h"

namespace throng {

Kernel procedural_kernel(const std::shared_ptr<Gpu>& gpu, uint32_t kind, bool similarities) {
    return kernels::procedural.on(gpu, {similarities, kind});
}

}  // namespace throng
