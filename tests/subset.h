// Runs of some of the tests, on devices or under checks where all would take too long: `throng_tests --subset NAME`.
#pragma once

#include <initializer_list>
#include <string>
#include <string_view>

namespace throng::test {

enum class Subset {
    // "gpu_assisted": under GPU-assisted validation, which finds accesses out of bounds. A kernel may take seconds
    // there, so these are few, but among them run the kernels of every stage and scan method.
    kGpuAssisted,
    kSubgroups,      // "subgroups": invocations that work together, with subgroups of another size
    kWideSubgroups,  // "wide_subgroups": those of them that exchange registers, with larger subgroups
    kNative,         // "native": on a device without Vulkan
    // "other_driver": those of "gpu_assisted", but for what is left out here: the same shaders with other numbers, and
    // tests that take long for shaders which others run too.
    kOtherDriver,
};

// A file of tests says by one of these, outside of functions, which of its tests belong to which of the subsets:
// by patterns as in --gtest_filter, of which those that begin with '-' leave out what others take in.
class InSubset {
public:
    InSubset(std::initializer_list<Subset> subsets, std::initializer_list<std::string_view> tests);
};

// The --gtest_filter of a subset. Throws std::runtime_error where there is none of this name, and where a pattern
// matches no test.
std::string filter_of_subset(std::string_view name);

}  // namespace throng::test
