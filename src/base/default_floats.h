// The floating-point environment that throng computes in.
#pragma once

#include <cstdint>

#if defined(__x86_64__)
#include <xmmintrin.h>
#endif

namespace throng {

// While it lives, this thread rounds to the nearest and keeps denormal numbers, whatever the application has set, and
// floating-point exceptions interrupt nothing; then all is as before. So results do not depend on which of an
// application's threads computes them, and lanes without an instance may divide by zero. Not by <cfenv>, which also
// saves and loads the x87's environment, for each job.
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
    static constexpr unsigned kDefault = 0x1F80;  // of MXCSR: nothing is set but that exceptions are masked
    unsigned before_;
#elif defined(__aarch64__)
    uint64_t before_;
#endif
};

}  // namespace throng
