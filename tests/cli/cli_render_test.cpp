// What `throng render` is told to show.
#include "tests/files.h"
#include "tests/tool_runner.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <filesystem>

namespace throng::test {
namespace {

class CliRender : public ToolTest {
protected:
    static void SetUpTestSuite() {
        ToolTest::SetUpTestSuite();
        for (const std::string kind : {"walker", "dragon"})
            generate(kind + ".glb", kind + " --joints 40 --levels 10 --faces 400");
    }
    static std::string picture(const std::string& out, const Words& more) {
        const Outcome outcome = run_tool(command(out) + more);
        EXPECT_TRUE(outcome.succeeded()) << outcome;
        return read_file(out);
    }
    static Words command(const std::string& out) {
        return "render walker.glb dragon.glb --count 4 --size 96x64 --time 0.5" + Words{"--out", out};
    }
    static bool refuses(const Words& more, const std::string& why) {
        return run_tool(command("refused.png") + more).refused(why) && !std::filesystem::exists("refused.png");
    }
};

TEST_F(CliRender, ClipsAreChosenByNameOrNumber) {
    const std::string random = picture("random.png", {}), first = picture("first.png", {"--clip", "0"}),
                      second = picture("second.png", {"--clip", "1"}),
                      one_file = picture("one_file.png", {"--clip", "walker.glb=0"});
    EXPECT_NE(random, first);
    EXPECT_NE(first, second);
    EXPECT_NE(one_file, first) << "the dragon's is at random";
    EXPECT_NE(one_file, random);
    const std::string name = Json::parse(succeed("info walker.glb --json").out)["clips"][0]["name"];
    EXPECT_EQ(picture("named.png", {"--clip", "walker.glb=" + name}), one_file);
    EXPECT_EQ(picture("all.png", {"--clip", "0", "--blend", "1", "--weight", "1"}), first);
    EXPECT_NE(picture("half.png", {"--clip", "0", "--blend", "1"}), first);

    EXPECT_TRUE(refuses({"--clip", "nowhere"}, "no clip 'nowhere'; there are: 0 '"));
    EXPECT_TRUE(refuses({"--clip", "fox.glb=0"}, "--clip fox.glb=0: 'fox.glb' is none of the files"));
    EXPECT_TRUE(refuses({"--clip", "0", "--blend", "99"}, "no clip '99'"));
    EXPECT_TRUE(refuses({"--blend", "0"}, "--clip"));
    EXPECT_TRUE(refuses({"--clip", "0", "--weight", "0.5"}, "--blend"));
    EXPECT_TRUE(refuses({"--clip", "0", "--blend", "1", "--weight", "1.5"}, "--weight"));
    EXPECT_TRUE(
        refuses({"--clip", "0", "--controller", "walker.glb=" THRONG_SOURCE_DIR "/examples/controllers/walker.json"},
                "--clip 0: walker.glb has a controller, which chooses the clips"));
}

TEST_F(CliRender, PicturesAreWrittenAsTheirNamesSay) {
    for (const std::string name : {"fox.jpg", "fox.PNG", "fox"}) {
        EXPECT_TRUE(run_tool(command(name)).refused("--out " + name + ": pictures are .png files")) << name;
        EXPECT_FALSE(std::filesystem::exists(name));
    }
}

}  // namespace
}  // namespace throng::test
