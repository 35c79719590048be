#include "native/lanes_sse2.h"

#include "native/kernel.h"
#include "native/kernels.h"

namespace throng::native {

const Kernel& kernel_sse2() {
    static constexpr Kernel kKernel{Lanes::kCount, scratch_bytes, update_all, decode_all, fill, Lanes::fence};
    return kKernel;
}

}  // namespace throng::native
