#include "native/lanes_avx512.h"

#include "native/kernel.h"
#include "native/kernels.h"

namespace throng::native {

const Kernel& kernel_avx512() {
    static constexpr Kernel kKernel{Lanes::kCount, scratch_bytes, update_all, decode_all, fill, Lanes::fence};
    return kKernel;
}

}  // namespace throng::native
