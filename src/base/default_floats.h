// The floating-point environment that throng computes in.
#pragma once

#include <cstdint>

#if defined(__x86_64__)
#include <xmmintrin.h>
#endif

namespace throng {

// While this object lives, its thread rounds to nearest, keeps denormals and does not trap on floating-point
// exceptions, whatever the application has set. The destructor restores the previous state. This way results do not
// depend on which of the application's threads computes them, and SIMD lanes without an instance may divide by zero.
// Does not use <cfenv>, which would also save and restore the x87 environment for each job.
class DefaultFloats {
public:
#if defined(__x86_64__)
    DefaultFloats() : before_(_mm_getcsr()) { _mm_setcsr(kDefault); }
    ~DefaultFloats() { _mm_setcsr(before_); }
#elif defined(__aarch64__)
    DefaultFloats() {
        asm volatile("mrs %0, fpcr" : "=r"(before_));
        asm volatile("msr fpcr, %0" ::"r"(uint64_t{0}));
    }
    ~DefaultFloats() { asm volatile("msr fpcr, %0" ::"r"(before_)); }
#else
    DefaultFloats() {}
    ~DefaultFloats() {}
#endif
    DefaultFloats(const DefaultFloats&) = delete;
    DefaultFloats& operator=(const DefaultFloats&) = delete;

private:
#if defined(__x86_64__)
    static constexpr unsigned kDefault = 0x1F80;  // MXCSR with all exceptions masked and no other bit set
    unsigned before_;
#elif defined(__aarch64__)
    uint64_t before_;
#endif
};

}  // namespace throng
