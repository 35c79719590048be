#include "native/lanes_avx2.h"

#include "raster/kernel.h"

namespace throng::raster {

const Kernel& kernel_avx2() {
    static constexpr Kernel kKernel = make_kernel();
    return kKernel;
}

}  // namespace throng::raster
