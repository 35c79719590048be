// Test subsets: their filters, and errors for unknown names and for patterns that match no test.
#include "tests/subset.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace throng::test {
namespace {

TEST(Subset, IsAFilterOfTestsThatAreThere) {
    EXPECT_THROW(filter_of_subset("nothing"), std::runtime_error);
    const InSubset some({Subset::kSubgroups, Subset::kGpuAssisted},
                        {"Subset.*", "-Subset.IsAFilterOfTestsThatAreThere"});
    EXPECT_EQ(filter_of_subset("subgroups"), "Subset.*:-Subset.IsAFilterOfTestsThatAreThere");
    const InSubset gone({Subset::kGpuAssisted}, {"-Subset.RenamedSince"});
    EXPECT_THROW(filter_of_subset("gpu_assisted"), std::runtime_error);
    EXPECT_NO_THROW(filter_of_subset("subgroups"));
}

}  // namespace
}  // namespace throng::test
