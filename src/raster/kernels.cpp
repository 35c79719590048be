#include "raster/kernels.h"

namespace throng::raster {

const Kernel& kernel_of(NativeIsa isa) {
#if defined(__x86_64__)
    if (isa == NativeIsa::kAvx512) return kernel_avx512();
    if (isa == NativeIsa::kAvx2) return kernel_avx2();
    return kernel_sse2();
#elif defined(__aarch64__)
    (void)isa;
    return kernel_neon();
#else
    (void)isa;  // native_isas() has none
    static constexpr Kernel kNone{};
    return kNone;
#endif
}

}  // namespace throng::raster
