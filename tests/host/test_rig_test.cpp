// The tests' own comparison functions: NaN must not pass.
#include "tests/test_rig.h"

#include <gtest/gtest.h>

namespace throng::test {
namespace {

TEST(TestRig, NanIsTheWorstError) {
    EXPECT_EQ(worse_of(1, 2), 2);
    EXPECT_EQ(worse_of(2, 1), 2);
    EXPECT_EQ(worse_of(kNan, 1), kInfinity);
    EXPECT_EQ(worse_of(1, kNan), kInfinity);
    EXPECT_EQ(worse_of(kInfinity, 1), kInfinity);
    for (const float wrong : {kNan, kInfinity, -kInfinity})
        for (const size_t column : {0u, 3u}) {
            Affine got;
            got.row[1][column] = wrong;
            EXPECT_EQ(matrix_error(got, {}, 1), kInfinity) << wrong << " in column " << column;
        }
}

}  // namespace
}  // namespace throng::test
