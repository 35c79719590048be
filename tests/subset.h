// Subsets of the tests, for devices or checks on which all tests take too long: `throng_tests --subset NAME`.
#pragma once

#include <initializer_list>
#include <string>
#include <string_view>

namespace throng::test {

enum class Subset {
    // "gpu_assisted": under GPU-assisted validation, which finds out-of-bounds accesses. A kernel may take seconds
    // there, so the subset is small, but it covers the kernels of every stage and scan method.
    kGpuAssisted,
    kSubgroups,      // "subgroups": cooperating invocations, with another subgroup size
    kWideSubgroups,  // "wide_subgroups": those that exchange registers, with larger subgroups
    kNative,         // "native": on a device without Vulkan
    // "other_driver": those of "gpu_assisted" except what is excluded here: the same shaders with other numbers, and
    // slow tests of shaders that other tests run, too.
    kOtherDriver,
};

// Defined outside of functions, one of these assigns tests of its file to subsets, by patterns as in --gtest_filter.
// Patterns that begin with '-' exclude tests.
class InSubset {
public:
    InSubset(std::initializer_list<Subset> subsets, std::initializer_list<std::string_view> tests);
};

// The --gtest_filter of a subset. Throws std::runtime_error if there is no subset of this name or a pattern matches no
// test.
std::string filter_of_subset(std::string_view name);

}  // namespace throng::test
