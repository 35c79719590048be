// Table rows for benchmark records without times. Each benchmark has its own field for the error of a wrong result, or
// none.
#include "tools/bench/measured.h"

#include <gtest/gtest.h>

#include <cmath>

namespace throng::tools {
namespace {

using testing::internal::CaptureStdout, testing::internal::GetCapturedStdout;

TEST(BenchRows, SayWhyThereAreNoTimes) {
    CaptureStdout();
    EXPECT_TRUE(print_untimed({{"wrong", true}, {"max_error", 0.5}}, "not measured"));
    EXPECT_TRUE(print_untimed({{"wrong", true}, {"max_error", std::nan("")}}, "not measured"));
    EXPECT_TRUE(print_untimed({{"wrong", true}, {"alike_db", 12.5}}, "not measured", " dB alike", "alike_db"));
    EXPECT_TRUE(print_untimed({{"wrong", true}}, "not measured", " dB alike", "alike_db"));
    EXPECT_TRUE(print_untimed({{"wrong", true}, {"max_error", nullptr}, {"characters", 40}, {"found", 41}}, ""));
    EXPECT_TRUE(print_untimed({{"unsupported_reason", "there is no llvmpipe"}}, "not measured"));
    EXPECT_FALSE(print_untimed({{"ms", 3}}, "not measured"));
    EXPECT_EQ(GetCapturedStdout(),
              "WRONG, not timed: 0.5 of the size off\n"
              "WRONG, not timed: a number is missing or not finite\n"
              "WRONG, not timed: 12.5 dB alike\n"
              "WRONG, not timed\n"
              "WRONG, not timed: there are 41 characters, not 40\n"
              "not measured: there is no llvmpipe\n");
}

}  // namespace
}  // namespace throng::tools
