// Runs kernels over vectors, as devices without Vulkan do.
#pragma once

#include "gpu/kernel_code.h"

#include <gtest/gtest.h>

#include <cstring>
#include <stdexcept>
#include <vector>

namespace throng::test {

// Values that a kernel is to overwrite: every float in them is NaN.
template <class T>
std::vector<T> unwritten(size_t count) {
    std::vector<T> out(count);
    if (count > 0) std::memset(static_cast<void*>(out.data()), 0xFF, count * sizeof(T));
    return out;
}

// A kernel and the vectors that it reads and writes, which must not move.
class NativeRun {
public:
    // `constants`: values for constant_id 1, 2, …
    explicit NativeRun(const NativeKernel* kernel, std::vector<uint32_t> constants = {}, uint32_t workgroup_size = 0)
        : kernel_(checked(kernel)),
          workgroup_size_(workgroup_size != 0 ? workgroup_size : kernel->workgroup_size),
          constants_(std::move(constants)) {
        constants_.insert(constants_.begin(), workgroup_size_);
        dispatch_.constants = constants_;
    }
    NativeRun(const NativeRun&) = delete;
    NativeRun& operator=(const NativeRun&) = delete;

    template <class T>
    NativeRun& bind(uint32_t number, std::vector<T>& items) {
        dispatch_.buffers[number] = reinterpret_cast<std::byte*>(items.data());
        return *this;
    }

    // Runs the second half first: no workgroup may depend on an earlier one.
    template <class Push>
    void workgroups(const Push& push, uint32_t count) {
        ASSERT_EQ(kernel_.push_bytes, sizeof push);
        dispatch_.push = &push;
        kernel_.run(dispatch_, count / 2, count);
        kernel_.run(dispatch_, 0, count / 2);
    }
    template <class Push>
    void invocations(const Push& push, uint32_t count) {
        workgroups(push, (count + workgroup_size_ - 1) / workgroup_size_);
    }

private:
    static const NativeKernel& checked(const NativeKernel* kernel) {
        if (!kernel) throw std::runtime_error("the kernel is not among THRONG_NATIVE_KERNELS of CMakeLists.txt");
        return *kernel;
    }

    const NativeKernel& kernel_;
    uint32_t workgroup_size_;
    std::vector<uint32_t> constants_;
    NativeDispatch dispatch_;
};

}  // namespace throng::test
