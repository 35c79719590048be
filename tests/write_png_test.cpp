// write_png(): pictures are the same after a round trip through a PNG file.
#include "tests/ball.h"
#include "tests/files.h"
#include "tests/png.h"

#include <throng/draw.h>

#include <gtest/gtest.h>

#include <filesystem>
#include <tuple>

namespace throng {
namespace {

namespace fs = std::filesystem;
using test::gradient, test::TemporaryFolder;

TEST(WritePng, RoundTrips) {
    const TemporaryFolder folder;
    const fs::path path = folder.path() / "picture.png";
    const Picture picture = gradient(13, 7);
    ASSERT_TRUE(write_png(path, picture));
    ASSERT_TRUE(write_png(path, picture)) << "replaces";
    const test::Png read = test::read_png(path);
    EXPECT_EQ(std::tuple(read.width, read.height, read.channels), std::tuple(13, 7, 4));
    EXPECT_EQ(read.rgba, picture.rgba);
    EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), {}), 1) << "the temporary file is gone";
}

TEST(WritePng, FailuresLeaveNoFile) {
    const TemporaryFolder temporary;
    const fs::path& folder = temporary.path();
    const Result<void> absent = write_png(folder / "absent" / "picture.png", gradient(2, 2));
    ASSERT_FALSE(absent);
    EXPECT_EQ(absent.error().code, ErrorCode::kFile);
    EXPECT_TRUE(fs::is_empty(folder));

    fs::create_directories(folder / "taken" / "by a folder");
    const Result<void> taken = write_png(folder / "taken", gradient(2, 2));
    ASSERT_FALSE(taken);
    EXPECT_EQ(taken.error().code, ErrorCode::kFile);
    EXPECT_EQ(std::distance(fs::directory_iterator(folder), {}), 1);

    const Result<void> torn = write_png(folder / "torn.png", {.width = 2, .height = 2, .rgba = {1, 2, 3}});
    ASSERT_FALSE(torn);
    EXPECT_EQ(torn.error().code, ErrorCode::kInvalidArgument);
    EXPECT_FALSE(fs::exists(folder / "torn.png"));
}

}  // namespace
}  // namespace throng
