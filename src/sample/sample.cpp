#include "sample/sample.h"

#include "sample/sample.kernel.h"

namespace throng {

Kernel sample_kernel(const std::shared_ptr<Gpu>& gpu, bool packed, bool varies) {
    return kernels::sample.on(gpu, {packed, varies});
}

}  // namespace throng
