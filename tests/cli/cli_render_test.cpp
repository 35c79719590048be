// The options of `throng render` and what they show.
#include "tests/files.h"
#include "tests/tool_runner.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <fstream>

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
    EXPECT_TRUE(run_tool("render ./walker.glb dragon.glb --count 4 --size 96x64 --time 0.5 --clip walker.glb=0 "
                         "--out without_its_folder.png")
                    .succeeded());
    EXPECT_EQ(read_file("without_its_folder.png"), one_file);
    EXPECT_TRUE(refuses({"--clip", "./walkr.glb=0"}, "did you mean 'walker.glb'?"));
    EXPECT_EQ(picture("all.png", {"--clip", "0", "--blend", "1", "--weight", "1"}), first);
    EXPECT_NE(picture("half.png", {"--clip", "0", "--blend", "1"}), first);
    const std::string blended = picture("blended.png", {"--clip", "walker.glb=0", "--blend", "walker.glb=1"});
    EXPECT_NE(blended, one_file);
    EXPECT_EQ(picture("blended.png", {"--clip", "walker.glb=0", "--blend", "1"}), blended) << "by those with a clip";

    EXPECT_TRUE(refuses({"--clip", "nowhere"}, "there is no clip 'nowhere'. There are: "));
    EXPECT_TRUE(refuses({"--clip", "fox.glb=0"}, "--clip fox.glb=0: there is no file 'fox.glb'. There are: "));
    EXPECT_TRUE(refuses({"--clip", "0", "--blend", "99"}, "no clip '99'"));
    EXPECT_TRUE(refuses({"--blend", "0"}, "--clip"));
    EXPECT_TRUE(refuses({"--clip", "walker.glb=0", "--blend", "dragon.glb=1"},
                        "--blend 1: dragon.glb has no --clip to blend it with"));
    EXPECT_TRUE(refuses({"--clip", "0", "--weight", "0.5"}, "--blend"));
    EXPECT_TRUE(refuses({"--clip", "0", "--blend", "1", "--weight", "1.5"}, "--weight"));
    const Words driven{"--clip", "0", "--controller",
                       "walker.glb=" THRONG_SOURCE_DIR "/examples/controllers/walker.json"};
    EXPECT_TRUE(refuses(driven, "--clip 0: walker.glb has a controller, which chooses the clips"));
    EXPECT_EQ(run_tool(command("refused.png") + driven).exit_code, 2) << "a wrong option";
}

TEST_F(CliRender, EachFileIsDrawnAndReported) {
    const Json json = json_of("render walker.glb dragon.glb --size 64x48 --out each.png");
    EXPECT_EQ(json["count"], 2);
    ASSERT_EQ(json["files"].size(), 2u);
    const Json four = json_of(command("four.png") + Words{"--scan", "serial"});
    for (const size_t k : {0u, 1u}) {
        EXPECT_EQ(json["files"][k]["file"], k == 0 ? "walker.glb" : "dragon.glb");
        EXPECT_EQ(json["files"][k]["count"], 1);
        EXPECT_EQ(four["files"][k]["count"], 2);
        EXPECT_EQ(four["files"][k]["scan"], "serial");
    }
    const Outcome text = succeed("render walker.glb dragon.glb --size 64x48 --path staged --out each.png");
    for (const char* name : {"walker.glb", "dragon.glb"})
        EXPECT_NE(text.out.find("  1 of " + std::string(name) + ", staged, scan by "), std::string::npos) << text;
    EXPECT_TRUE(run_tool("render walker.glb dragon.glb --count 1 --out refused.png")
                    .refused("--count 1: there are 2 files; give at least one character for each"));
}

TEST_F(CliRender, LooksAreChosenForEachCharacter) {
    const std::string walker = "walker.glb=" THRONG_SOURCE_DIR "/examples/looks/walker.json";
    const std::string plain = picture("plain.png", {}), looks = picture("looks.png", {"--looks", walker});
    EXPECT_TRUE(plain != looks);
    EXPECT_TRUE(picture("again.png", {"--looks", walker}) == looks);
    EXPECT_TRUE(picture("seed.png", {"--looks", walker, "--seed", "2"}) != looks);
    EXPECT_TRUE(picture("dragons.png", {"--looks", "dragon.glb=" THRONG_SOURCE_DIR "/examples/looks/dragon.json"}) !=
                plain);

    const auto refuses_file = [](const std::string& json, const std::string& why) {
        std::ofstream("looks.json") << json;
        return refuses({"--looks", "walker.glb=looks.json"}, why);
    };
    std::ofstream("looks.json") << R"({"wear": {"head": {"all": ["creature"], "a": [], "b": [], "c": [], "d": []}}})";
    EXPECT_TRUE(picture("worn.png", {"--looks", "walker.glb=looks.json"}) != plain);
    std::ofstream("looks.json") << R"({"materials": {"cloak": ["skin", "hair"]}})";
    EXPECT_TRUE(picture("dressed.png", {"--looks", "walker.glb=looks.json"}) != plain);
    EXPECT_TRUE(refuses_file(R"({"materials": {"cloak": ["cloak", "cloack"]}})",
                             "looks.json:1: materials.cloak[1]: there is no material 'cloack'; did you mean 'cloak'?"));
    EXPECT_TRUE(refuses_file(R"({"materials": {"cloak": []}})", "looks.json:1: materials.cloak: must not be empty"));
    EXPECT_TRUE(refuses_file("{\n\"colors\": {\"clok\": [\"#ffffff\"]}}",
                             "looks.json:2: colors.clok: there is no material 'clok'; did you mean 'cloak'?"));
    EXPECT_TRUE(refuses_file(R"({"colors": {"cloak": ["red"]}})",
                             "looks.json:1: colors.cloak[0]: must be a colour like \"#c03a2b\", but is 'red'"));
    EXPECT_TRUE(refuses_file(R"({"colors": {"cloak": []}})", "looks.json:1: colors.cloak: must not be empty"));
    EXPECT_TRUE(refuses_file(R"({"wear": {"hand": {"sword": ["sword"]}}})",
                             "looks.json:1: wear.hand.sword[0]: there is no section 'sword'"));
    EXPECT_TRUE(refuses_file(R"({"tint": {"materials": ["cloak"]}})", "looks.json:1: tint: 'between' is missing"));
    EXPECT_TRUE(refuses_file(R"({"hats": 3})", "looks.json:1: hats"));
    EXPECT_TRUE(refuses_file("{", "looks.json"));
    EXPECT_TRUE(refuses({"--looks", "walker.glb=nowhere.json"}, "nowhere.json"));
    EXPECT_TRUE(refuses({"--looks", "fox.glb=looks.json"},
                        "--looks fox.glb=looks.json: there is no file 'fox.glb'. There are: "));
    EXPECT_TRUE(refuses({"--looks", "a.json", "--looks", "b.json"}, "--looks b.json: 'a.json' is given already"));
    EXPECT_TRUE(refuses({"--looks", "walker.glb="}, "--looks walker.glb=: nothing is given after '='"));
    std::filesystem::copy_file("walker.glb", "a=b.glb");
    EXPECT_TRUE(run_tool({"render", "a=b.glb", "--looks", "a=b.glb=c=d.json", "--out", "a=b.png"})
                    .refused("c=d.json: no such file"));
}

TEST_F(CliRender, OptionsOfDrawingTakeEffect) {
    const std::string plain = picture("plain.png", {}), skeletons = picture("skeletons.png", {"--skeletons"}),
                      bounds = picture("bounds.png", {"--bounds"});
    EXPECT_TRUE(skeletons != plain && bounds != plain && skeletons != bounds);
    EXPECT_TRUE(picture("coarse.png", {"--lod-pixels", "50"}) != plain);
    EXPECT_TRUE(picture("dual.png", {"--skinning", "dual-quaternion"}) != plain);
    // The pictures are the same, but the stages do other work.
    const auto stages_ms = [](const Words& more) { return json_of(command("timed.png") + more)["stages_ms"]; };
    const Json usual = stages_ms({});
    EXPECT_GT(usual["cull"], 0);
    EXPECT_EQ(usual["skin"], 0);
    EXPECT_EQ(stages_ms({"--everything"})["cull"], 0);
    EXPECT_GT(stages_ms({"--skin-once"})["skin"], 0);
}

TEST_F(CliRender, OnlyPngFileNamesAreAccepted) {
    for (const std::string name : {"fox.jpg", "fox.PNG", "fox"}) {
        EXPECT_TRUE(run_tool(command(name)).refused("--out " + name + ": pictures are .png files")) << name;
        EXPECT_FALSE(std::filesystem::exists(name));
    }
}

}  // namespace
}  // namespace throng::test
