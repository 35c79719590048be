#include "update_rate/update_rate.h"

#include "update_rate/update_rate.kernel.h"

namespace throng {

Kernel update_rate_kernel(const std::shared_ptr<Gpu>& gpu, SkinFormat format) {
    return kernels::update_rate.on(gpu, {static_cast<uint32_t>(format)});
}

}  // namespace throng
