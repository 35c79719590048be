#include "native/lanes_neon.h"

#include "raster/kernel.h"

namespace throng::raster {

const Kernel& kernel_neon() {
    static constexpr Kernel kKernel = make_kernel();
    return kKernel;
}

}  // namespace throng::raster
