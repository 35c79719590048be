#include "native/lanes_sse2.h"

#include "raster/kernel.h"

namespace throng::raster {

const Kernel& kernel_sse2() {
    static constexpr Kernel kKernel = make_kernel();
    return kKernel;
}

}  // namespace throng::raster
