#include "tests/subset.h"

#include <gtest/gtest.h>

#include <fnmatch.h>

#include <array>
#include <stdexcept>
#include <vector>

namespace throng::test {
namespace {

constexpr std::array<std::string_view, 5> kSubsetNames{"gpu_assisted", "subgroups", "wide_subgroups", "native",
                                                       "other_driver"};  // [Subset]

struct Patterns {
    std::vector<std::string> taken, left_out;
};

// Filled by static initialisation, before main().
std::array<Patterns, kSubsetNames.size()>& patterns() {
    static std::array<Patterns, kSubsetNames.size()> of_subsets;
    return of_subsets;
}

void check_that_one_matches(const std::string& pattern) {
    const testing::UnitTest& all = *testing::UnitTest::GetInstance();
    for (int s = 0; s < all.total_test_suite_count(); ++s)
        for (int t = 0; t < all.GetTestSuite(s)->total_test_count(); ++t) {
            const testing::TestInfo& test = *all.GetTestSuite(s)->GetTestInfo(t);
            const std::string name = std::string(test.test_suite_name()) + "." + test.name();
            if (fnmatch(pattern.c_str(), name.c_str(), 0) == 0) return;
        }
    throw std::runtime_error("a subset has '" + pattern + "', and no test is called so");
}

std::string joined(const std::vector<std::string>& all) {
    std::string text;
    for (const std::string& pattern : all) {
        check_that_one_matches(pattern);
        text += (text.empty() ? "" : ":") + pattern;
    }
    return text;
}

}  // namespace

InSubset::InSubset(std::initializer_list<Subset> subsets, std::initializer_list<std::string_view> tests) {
    for (const Subset subset : subsets)
        for (const std::string_view test : tests) {
            Patterns& of_subset = patterns()[static_cast<size_t>(subset)];
            if (test.starts_with('-'))
                of_subset.left_out.emplace_back(test.substr(1));
            else
                of_subset.taken.emplace_back(test);
        }
}

std::string filter_of_subset(std::string_view name) {
    for (size_t subset = 0; subset < kSubsetNames.size(); ++subset) {
        if (kSubsetNames[subset] != name) continue;
        Patterns of_subset = patterns()[subset];
        if (static_cast<Subset>(subset) == Subset::kOtherDriver) {
            const Patterns& base = patterns()[static_cast<size_t>(Subset::kGpuAssisted)];
            of_subset.taken.insert(of_subset.taken.end(), base.taken.begin(), base.taken.end());
            of_subset.left_out.insert(of_subset.left_out.end(), base.left_out.begin(), base.left_out.end());
        }
        if (!of_subset.taken.empty()) return joined(of_subset.taken) + ":-" + joined(of_subset.left_out);
    }
    throw std::runtime_error("no test is in a subset '" + std::string(name) + "'");
}

}  // namespace throng::test
