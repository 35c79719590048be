// The viewer's background loading.
#include "tools/view/loader.h"
#include "tests/tool_runner.h"

#include <cstdlib>
#include <filesystem>
#include <iterator>
#include <optional>
#include <string>

namespace throng {
namespace {

using namespace test;
namespace fs = std::filesystem;

// Files that are loaded completely are kept in the cache folder, here one of the tests' own.
class ViewLoader : public ToolTest {
protected:
    static void SetUpTestSuite() {
        ToolTest::SetUpTestSuite();
        generate("small.glb", "--joints 40 --levels 12 --faces 600");
        generate("large.glb", "--joints 300 --levels 60 --faces 50000");
    }
    void SetUp() override {
        if (const char* cache = std::getenv("XDG_CACHE_HOME")) before_ = cache;
        setenv("XDG_CACHE_HOME", file("cache").c_str(), 1);
    }
    void TearDown() override {
        before_ ? setenv("XDG_CACHE_HOME", before_->c_str(), 1) : unsetenv("XDG_CACHE_HOME");
        fs::remove_all(file("cache"));
    }
    static auto kept_count() {
        std::error_code none_yet;
        return std::distance(fs::directory_iterator(file("cache/throng/characters"), none_yet), {});
    }

    std::optional<std::string> before_;
};

TEST_F(ViewLoader, AReplacedLoadIsCancelled) {
    view::Loader loader;
    loader.start({file("large.glb")}, {});
    loader.start({file("small.glb")}, {});
    const auto read = loader.take(true);
    ASSERT_TRUE(read && read->size() == 1);
    EXPECT_EQ(read->front().name, "small.glb");
    EXPECT_EQ(loader.part_done(), 1);
    EXPECT_EQ(kept_count(), 1) << "the small one alone";
}

TEST_F(ViewLoader, ALoadInProgressIsCancelledAtExit) {
    {
        view::Loader loader;
        loader.start({file("large.glb")}, {});
    }
    EXPECT_EQ(kept_count(), 0);
}

}  // namespace
}  // namespace throng
