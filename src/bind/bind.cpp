#include "bind/bind.h"

#include "bind/bind.kernel.h"

namespace throng {

Kernel bind_kernel(const std::shared_ptr<Gpu>& gpu, SkinFormat format, bool varies) {
    return kernels::bind.on(gpu, {static_cast<uint32_t>(format), varies});
}

}  // namespace throng
