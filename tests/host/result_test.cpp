// Result: access to its value or error, expect(), and aborts on misuse.
#include <throng/result.h>

#include <gtest/gtest.h>

#include <csignal>
#include <memory>
#include <string>

namespace throng {
namespace {

const Error kError{ErrorCode::kFile, "fox.glb", "cannot be opened"};

TEST(Result, ValueOrReturnsTheValueOrTheDefault) {
    EXPECT_EQ(Result<int>(3).value_or(4), 3);
    EXPECT_EQ(Result<int>(kError).value_or(4), 4);
    EXPECT_EQ(*Result<std::unique_ptr<int>>(std::make_unique<int>(5)).value_or(nullptr), 5);
}

TEST(Result, ExpectReturnsTheValueOrExits) {
    EXPECT_EQ(Result<int>(3).expect(), 3);
    EXPECT_EQ(*Result<std::unique_ptr<int>>(std::make_unique<int>(5)).expect(), 5);
    Result<void>().expect();
    const auto one_line = "^fox.glb: cannot be opened\n$";
    EXPECT_EXIT(Result<int>(kError).expect(), testing::ExitedWithCode(1), one_line);
    EXPECT_EXIT(Result<void>(kError).expect(), testing::ExitedWithCode(1), one_line);
}

TEST(Result, AccessWithoutAValueAbortsWithTheError) {
    const auto aborts = testing::KilledBySignal(SIGABRT);
    const Result<std::string> failed(kError);
    const auto its_error = "^throng::Result without a value: fox.glb: cannot be opened\n$";
    EXPECT_EXIT(static_cast<void>(*failed), aborts, its_error);
    EXPECT_EXIT(static_cast<void>(failed->size()), aborts, its_error);
    EXPECT_EXIT(static_cast<void>(Result<int>(kError).value()), aborts, its_error);
    EXPECT_EXIT(static_cast<void>(Result<int>(3).error()), aborts, "^throng::Result::error\\(\\): there is none");
    EXPECT_EXIT(static_cast<void>(Result<void>().error()), aborts, "^throng::Result::error\\(\\): there is none");
}

}  // namespace
}  // namespace throng
