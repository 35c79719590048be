// The kernels of the instruction sets that this program was compiled for.
#pragma once

#include "native/kernel_update.h"

namespace throng::native {

#if defined(__x86_64__)
const Kernel& kernel_sse2();
const Kernel& kernel_avx2();
const Kernel& kernel_avx512();
#elif defined(__aarch64__)
const Kernel& kernel_neon();
#endif

}  // namespace throng::native
