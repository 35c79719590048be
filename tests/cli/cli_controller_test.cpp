// `throng controller`: its subcommands check and graph.
#include "tests/text.h"
#include "tests/tool_runner.h"

#include <nlohmann/json.hpp>

#include <set>

namespace throng {
namespace {

using namespace test;
namespace fs = std::filesystem;

// Runs in a folder that contains a creature.
class CliController : public ToolTest {
protected:
    static void SetUpTestSuite() {
        ToolTest::SetUpTestSuite();
        generate("creature.glb", "--joints 40 --levels 12 --faces 200");
        fs::copy(THRONG_SOURCE_DIR "/examples/controllers", "controllers");
    }
};

TEST_F(CliController, CheckListsTheController) {
    for (const std::string name : {"walker", "flyer", "dragon"}) {
        const Outcome text = succeed("controller check controllers/" + name + ".json --character creature.glb");
        EXPECT_TRUE(contains(text.out, "drives     creature.glb")) << text;
    }
    const Outcome text = run_tool("controller check controllers/dragon.json");
    for (const char* said :
         {"9 parameters, 2 masks, 3 layers, 12 states, 17 transitions, 3 events", "pace           float, initially 1",
          "grounded       bool, initially true", "jump           trigger\n",
          "layer 1    front: override, mask front, weight watch; 3 states",
          "tail: additive, mask tail, weight 0.6 * pace", "fly at (0, 3) by side and forward",
          "(any)          -> take off: jump triggered, grounded; 0.2 s; interrupts", "fidget         idle, once",
          "wing beat      fly at 0.25 s"})
        EXPECT_TRUE(contains(text.out, said)) << said << "\n" << text.out;

    const Outcome run = succeed("controller check controllers/dragon.json --json");
    const Json json = Json::parse(run.out, nullptr, false);
    EXPECT_EQ(json["parameters"].size(), 9u);
    EXPECT_EQ(json["parameters"][3], Json::parse(R"({"name": "pace", "type": "float", "initial": 1.0})"));
    EXPECT_EQ(json["masks"], Json::parse(R"(["front", "tail"])"));
    EXPECT_EQ(json["events"][2]["at_s"], 0.25);
    EXPECT_EQ(json["layers"][0]["states"][0]["name"], "stand");
    EXPECT_EQ(json["layers"][0]["transitions"][0]["from"], "*");
    EXPECT_EQ(json["layers"][2]["mode"], "additive");
    EXPECT_TRUE(json["warnings"].empty());
}

TEST_F(CliController, AnUnreachableStateIsAWarning) {
    write("lonely.json", R"({"layers": [{"name": "body",
      "states": {"a": {"clip": "idle"}, "b": {"clip": "walk"}, "c": {"clip": "fly"}},
      "transitions": [{"from": "b", "to": "c"}, {"to": "a", "exit": 2}]}]})");
    const Outcome run = run_tool("controller check lonely.json");
    EXPECT_EQ(run.exit_code, 0);
    EXPECT_EQ(run.err,
              "throng: warning: lonely.json: layer 'body': no transitions lead to state 'b'\n"
              "throng: warning: lonely.json: layer 'body': no transitions lead to state 'c'\n");
}

TEST_F(CliController, AnExitThatIsNeverReachedIsAWarning) {
    write("vain.json", R"({"layers": [{"name": "body",
      "states": {"a": {"clip": "idle", "speed": 0}, "b": {"clip": "walk", "speed": -2}},
      "transitions": [{"from": "a", "to": "b", "exit": 1},
                      {"from": "b", "to": "a", "exit": 1, "fade": "inertial"}]}]})");
    const Outcome run = run_tool("controller check vain.json --character creature.glb");
    EXPECT_EQ(run.exit_code, 0) << run;
    EXPECT_EQ(
        run.err,
        "throng: warning: vain.json: layer 'body': the transition from 'a' to 'b' waits for its 'exit' for ever: "
        "the state's speed is 0\n"
        "throng: warning: vain.json: layer 'body': the inertial fade to 'a' has no 'fade_s', so the pose jumps\n");
    EXPECT_TRUE(contains(run.out, "walk, speed -2")) << run;
}

TEST_F(CliController, GraphHasEveryStateAndTransition) {
    const Outcome run = succeed("controller graph controllers/dragon.json -o dragon.dot");
    const std::string dot = read_file("dragon.dot");
    EXPECT_EQ(count_of(dot, "subgraph cluster_"), 3u);
    EXPECT_EQ(count_of(dot, "_any ["), 3u);
    EXPECT_EQ(count_of(dot, "fillcolor"), 1u);
    EXPECT_EQ(count_of(dot, "_state"), 12 + 17 * 2 - 3u)
        << "12 nodes; 17 edges with two ends, of which 3 are any state";
    EXPECT_EQ(count_of(dot, " -> "), 17u);
    EXPECT_EQ(count_of(dot, "style=dashed];"), 3 + 3u) << "inertial fades, and any state";
    for (const char* said :
         {"label=\"tail (additive, mask tail, weight 0.6 * pace)\"",
          "layer0_state0 [label=\"stand\\nidle\", penwidth=2.5]", "label=\"fidget\\nidle\\nonce, speed 1.5\"",
          "layer0_any -> layer0_state3 [label=\" jump triggered, grounded \\n 0.2 s, interrupts \"]",
          "layer0_state2 -> layer0_state0 [label=\" forward > -0.05, forward < 0.05 \\n 0.3 s, interrupts \"]",
          "5 clips by side and forward"})
        EXPECT_TRUE(contains(dot, said)) << said << "\n" << dot;
    fs::remove("dragon.dot");

    write("odd.json", R"({"layers": [{"name": "a \" \\ é", "states": {"<s> \\N": {"clip": "\"]"}}}, {"name": "b"}]})");
    succeed("controller graph odd.json -o odd.dot");
    const std::string odd_dot = read_file("odd.dot");
    EXPECT_NE(odd_dot.find(R"x(label="a \" \\ é (override)")x"), std::string::npos) << odd_dot;
    EXPECT_NE(odd_dot.find(R"([label="<s> \\N\n\"]")"), std::string::npos) << odd_dot;
    EXPECT_TRUE(contains(odd_dot, "plays what Crowd::play() sets")) << odd_dot;
    fs::remove("odd.dot");
}

TEST_F(CliController, GraphIsDrawnByGraphviz) {
    if (std::system("command -v dot > /dev/null") != 0)
        GTEST_SKIP() << "no Graphviz here (Debian: apt-get install graphviz)";
    for (const std::string name : {"walker", "flyer", "dragon"}) {
        const Outcome run = succeed("controller graph controllers/" + name + ".json --out drawn.svg");
        const std::string svg = read_file("drawn.svg");
        EXPECT_TRUE(svg.starts_with("<?xml") && svg.find("</svg>") != svg.npos) << svg.substr(0, 200);
        if (name == "walker") {
            EXPECT_EQ(count_of(svg, "class=\"node\""), 2u);
            EXPECT_EQ(count_of(svg, "class=\"edge\""), 2u);
        }
    }
    fs::remove("drawn.svg");
}

TEST_F(CliController, WithoutGraphvizOnlyDotFilesAreWritten) {
    const std::set<fs::path> before = files();
    const RunSettings nowhere{.environment = {{"PATH", "/nowhere"}}};
    const Outcome run = run_tool("controller graph controllers/walker.json -o walker.svg", nowhere);
    EXPECT_TRUE(run.refused("Graphviz is not installed")) << run;
    EXPECT_EQ(files(), before);
    succeed("controller graph controllers/walker.json -o walker.dot", nowhere);
    fs::remove("walker.dot");
}

TEST_F(CliController, WrongInputIsRefusedAndNothingIsLeftBehind) {
    const std::string swim = "{\"layers\": [\n{\"name\": \"body\", \"states\": {\"swim\": {\"clip\": \"swim\"}}";
    write("swimmer.json", swim + "}]}");
    write("wrong.json", swim + ",\n\"transitions\": [{\"to\": \"swin\", \"exit\": 1}]}]}");
    expect_refused(
        {{"controller", "check or graph"},
         {"controller chekc swimmer.json", "chekc"},
         {"controller check", "file"},
         {"controller check missing.json", "missing.json: no such file"},
         {{"controller", "check", folder_->path().string()}, "not a regular file"},
         {"controller check creature.glb", "creature.glb:1: not JSON"},
         {"controller check wrong.json",
          "wrong.json:3: layers[0].transitions[0].to: there is no state 'swin'; did you mean 'swim'? There is: swim"},
         {"controller check swimmer.json --character creature.glb",
          "swimmer.json with creature.glb: layers[0].states.swim.clip: there is no clip 'swim'. There are: idle, walk, "
          "fly, glide, roar"},
         {"controller check swimmer.json --character swimmer.json", "swimmer.json"},
         {"controller graph swimmer.json", "--out"},
         {"controller graph swimmer.json -o a.png", "neither in .svg nor in .dot"},
         {"controller graph swimmer.json -o nowhere/a.svg", "nowhere"},
         {"controller graph wrong.json -o a.dot", "wrong.json:3"}});
}

}  // namespace
}  // namespace throng
