// `throng compile`, and the other commands with what it writes in place of its source.
#include "tests/tool_runner.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <set>

namespace throng {
namespace {

using namespace test;
namespace fs = std::filesystem;

// With a creature in the folder.
class CliCompile : public ToolTest {
protected:
    static void SetUpTestSuite() {
        ToolTest::SetUpTestSuite();
        generate("creature.glb", {"--joints", "30", "--levels", "9", "--faces", "400"});
    }

    static std::string source() { return file("creature.glb"); }
};

TEST_F(CliCompile, WhatIsWrittenGivesWhatItsSourceGives) {
    const std::string compiled = file("creature.throng");
    for (const std::string error : {"0.01", "0.5", "exact"}) {
        const Outcome run = run_tool({"compile", source(), "-o", compiled, "--error", error});
        ASSERT_TRUE(run.succeeded()) << run;
        EXPECT_EQ(json_of({"info", compiled}), json_of({"info", source(), "--error", error, "--lods"}));
        for (const std::vector<std::string>& of : std::vector<std::vector<std::string>>{
                 {"--reference"},
                 {},
                 {"--clip", "walk", "--time", "0.3", "--reference"},
                 {"--clip", "0", "--time", "1", "--blend", "fly", "--blend-time", "0.2"}}) {
            std::vector<std::string> by_file{"pose", compiled, "--vertices", "all"},
                by_source{"pose", source(), "--error", error, "--vertices", "all"};
            by_file.insert(by_file.end(), of.begin(), of.end());
            by_source.insert(by_source.end(), of.begin(), of.end());
            EXPECT_TRUE(json_of(by_file) == json_of(by_source)) << error << ", " << testing::PrintToString(of);
        }
    }
    fs::remove(compiled);
}

TEST_F(CliCompile, OtherCommandsTakeItToo) {
    const std::string compiled = file("creature.throng");
    ASSERT_TRUE(run_tool({"compile", source(), "-o", compiled}).succeeded());
    const auto picture = [&](const std::string& of, const char* name) {
        const Outcome run = run_tool(
            {"render", of, "--count", "3", "--size", "64x48", "--time", "0.4", "--out", file(name)});
        EXPECT_TRUE(run.succeeded()) << run;
        const std::string bytes = read_file(file(name));
        fs::remove(file(name));
        return bytes;
    };
    EXPECT_EQ(picture(compiled, "compiled.png"), picture(source(), "source.png"));
    const Outcome bench = run_tool({"bench", compiled, "--count", "20", "--samples", "2"});
    EXPECT_EQ(bench.exit_code, 0) << bench;
    fs::remove(compiled);
}

TEST_F(CliCompile, ItSaysWhatItWroteAndHowExactItIs) {
    const std::string compiled = file("creature.throng");
    double clip_bytes_before = 0;
    for (const char* error : {"0.001", "0.01", "1"}) {
        const Json json = json_of({"compile", source(), "--out", compiled, "--error", error});
        EXPECT_EQ(json["file"], source());
        EXPECT_EQ(json["out"], compiled);
        EXPECT_EQ(json["bytes"], fs::file_size(compiled));
        EXPECT_EQ(json["joints"], 30);
        EXPECT_EQ(json["packed"], true);
        EXPECT_NEAR(json["error_bound_percent"].get<double>(), std::stod(error), 1e-12);
        EXPECT_GT(json["error_percent"], 0);
        EXPECT_LE(json["error_percent"], std::stod(error));
        double clip_bytes = 0, clip_raw_bytes = 0, largest_percent = 0;
        ASSERT_EQ(json["clips"].size(), 5u);
        for (const Json& clip : json["clips"]) {
            clip_bytes += clip["bytes"].get<double>();
            clip_raw_bytes += clip["raw_bytes"].get<double>();
            largest_percent = std::max(largest_percent, clip["error_percent"].get<double>());
        }
        EXPECT_EQ(json["clip_bytes"], clip_bytes);
        EXPECT_EQ(json["clip_raw_bytes"], clip_raw_bytes);
        EXPECT_EQ(json["error_percent"], largest_percent);
        EXPECT_NEAR(json["ratio"].get<double>(), clip_raw_bytes / clip_bytes, 1e-9);
        EXPECT_TRUE(clip_bytes_before == 0 || clip_bytes < clip_bytes_before) << error;
        EXPECT_TRUE(json["warnings"].empty());
        clip_bytes_before = clip_bytes;
    }
    const Json exact = json_of({"compile", source(), "--out", compiled, "--error", "exact"});
    EXPECT_EQ(exact["packed"], false);
    EXPECT_EQ(exact["error_percent"], 0);

    const Outcome packed = run_tool({"compile", source(), "-o", compiled}),
                  text = run_tool({"compile", source(), "-o", compiled, "--error", "exact"});
    EXPECT_TRUE(packed.succeeded() && packed.out.find("0.01 % allowed") != std::string::npos) << packed;
    EXPECT_TRUE(text.succeeded() && text.out.find("exact keys") != std::string::npos) << text;
    EXPECT_NE(text.out.find(std::to_string(fs::file_size(compiled)) + " bytes"), std::string::npos) << text;
    fs::remove(compiled);
}

TEST_F(CliCompile, WrongInputIsRefusedAndNothingIsLeftBehind) {
    const std::string compiled = file("sound.throng"), out = file("out.throng");
    ASSERT_TRUE(run_tool({"compile", source(), "-o", compiled}).succeeded());
    std::string bytes = read_file(compiled);
    bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
    const std::string damaged = write("damaged.throng", bytes);
    bytes[8] = 3;
    const std::string newer = write("newer.throng", bytes);
    write("cut.throng", bytes.substr(0, 5) + '\0');
    write("text.glb", "This is not glTF.\n");
    fs::create_directory(file("folder"));
    const std::string source_before = read_file(source()), compiled_before = read_file(compiled);
    expect_refused(
        {{{"compile"}, "file"},
         {{"compile", source()}, "--out"},
         {{"compile", file("missing.glb"), "-o", out}, "missing.glb"},
         {{"compile", file("folder"), "-o", out}, "folder"},
         {{"compile", file("text.glb"), "-o", out}, "text.glb"},
         {{"compile", file("text.glb"), "-o", compiled}, "text.glb"},
         {{"compile", source(), "-o", file("nowhere/out.throng")}, "nowhere"},
         {{"compile", source(), "-o", file("folder")}, "folder"},
         {{"compile", source(), "-o", "/dev/null"}, "/dev/null"},
         {{"compile", source(), "-o", source()}, "would be written over " + source()},
         {{"compile", compiled, "-o", out}, "compiled already"},
         {{"compile", damaged, "-o", out}, "damaged.throng: is damaged"},
         {{"compile", newer, "-o", out}, "newer.throng: version 3, this throng reads version 2"},
         {{"compile", source(), "-o", file("text.glb")}, "text.glb is there, and not a compiled character"},
         {{"compile", source(), "-o", out, "--error", "0"}, "--error"},
         {{"compile", source(), "-o", out, "--error", "-1"}, "-1"},
         {{"compile", source(), "-o", out, "--error", "11"}, "'11'"},
         {{"compile", source(), "-o", out, "--error", "nan"}, "'nan'"},
         {{"compile", source(), "-o", out, "--error", "1x"}, "'1x'"},
         {{"compile", source(), "-o", out, "--error", ""}, "--error"},
         {{"info", damaged}, "damaged.throng: is damaged"},
         {{"pose", damaged}, "damaged.throng: is damaged"},
         {{"render", damaged, "--out", file("picture.png")}, "damaged.throng: is damaged"},
         {{"bench", damaged}, "damaged.throng: is damaged"},
         {{"info", compiled, "--error", "0.01"}, "sound.throng is compiled already"},
         {{"pose", compiled, "--error", "exact"}, "sound.throng is compiled already"},
         {{"render", source(), compiled, "--error", "1", "--out", file("picture.png")},
          "sound.throng is compiled already"},
         {{"bench", compiled, "--error", "1"}, "sound.throng is compiled already"},
         {{"bench", "frame", compiled, "--error", "1"}, "sound.throng is compiled already"},
         {{"compile", compiled, "-o", out, "--error", "1"}, "sound.throng is compiled already"},
         {{"compile", source(), "-o", out, "--root-motion", "nobody"}, "there is no joint 'nobody'"},
         {{"info", compiled, "--root-motion", "spine"}, "sound.throng is compiled already, with its own root motion"},
         {{"info", newer}, "newer.throng: version 3, this throng reads version 2"},
         {{"info", file("cut.throng")}, "cut.throng"}});
    EXPECT_EQ(read_file(source()), source_before);
    EXPECT_EQ(read_file(compiled), compiled_before);
    EXPECT_TRUE(fs::is_empty(file("folder")));
}

}  // namespace
}  // namespace throng
