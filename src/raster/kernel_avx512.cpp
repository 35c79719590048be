#include "native/lanes_avx512.h"

#include "raster/kernel.h"

namespace throng::raster {

const Kernel& kernel_avx512() {
    static constexpr Kernel kKernel = make_kernel();
    return kKernel;
}

}  // namespace throng::raster
