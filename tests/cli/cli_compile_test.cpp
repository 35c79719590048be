// `throng compile`, and the other commands given its output instead of the source file.
#include "tests/text.h"
#include "tests/tool_runner.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <fstream>
#include <set>
#include <sys/stat.h>

namespace throng {
namespace {

using namespace test;
namespace fs = std::filesystem;

// Runs in a folder that contains a creature.
class CliCompile : public ToolTest {
protected:
    static void SetUpTestSuite() {
        ToolTest::SetUpTestSuite();
        generate("creature.glb", "--joints 30 --levels 9 --faces 400");
    }
};

TEST_F(CliCompile, ACompiledFileGivesTheResultsOfItsSource) {
    for (const std::string error : {"0.01", "0.5", "exact"}) {
        const Outcome run = succeed("compile creature.glb -o creature.throng --error " + error);
        EXPECT_EQ(json_of("info creature.throng"), json_of("info creature.glb --error " + error + " --lods"));
        for (const std::string of : {"--reference", "", "--clip walk --time 0.3 --reference",
                                     "--clip 0 --time 1 --blend fly --blend-time 0.2"})
            EXPECT_TRUE(json_of("pose creature.throng --vertices all " + of) ==
                        json_of("pose creature.glb --error " + error + " --vertices all " + of))
                << error << ", " << of;
    }
    fs::remove("creature.throng");
}

TEST_F(CliCompile, OtherCommandsAcceptCompiledFiles) {
    succeed("compile creature.glb -o creature.throng");
    const auto picture = [&](const std::string& of, const char* name) {
        const Outcome run = succeed(
            {"render", of, "--count", "3", "--size", "64x48", "--time", "0.4", "--out", file(name)});
        const std::string bytes = read_file(file(name));
        fs::remove(file(name));
        return bytes;
    };
    EXPECT_EQ(picture("creature.throng", "compiled.png"), picture("creature.glb", "source.png"));
    const Outcome bench = run_tool("bench creature.throng --count 20 --samples 2");
    EXPECT_EQ(bench.exit_code, 0) << bench;
    fs::remove("creature.throng");
}

TEST_F(CliCompile, ReportsItsOutputAndItsError) {
    double clip_bytes_before = 0;
    for (const std::string error : {"0.001", "0.01", "1"}) {
        const Json json = json_of("compile creature.glb --out creature.throng --error " + error);
        EXPECT_EQ(json["file"], "creature.glb");
        EXPECT_EQ(json["out"], "creature.throng");
        EXPECT_EQ(json["bytes"], fs::file_size("creature.throng"));
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
    const Json exact = json_of("compile creature.glb --out creature.throng --error exact");
    EXPECT_EQ(exact["packed"], false);
    EXPECT_EQ(exact["error_percent"], 0);

    const Outcome packed = run_tool("compile creature.glb -o creature.throng"),
                  text = run_tool("compile creature.glb -o creature.throng --error exact");
    EXPECT_TRUE(packed.succeeded() && contains(packed.out, "0.01 % allowed")) << packed;
    EXPECT_TRUE(text.succeeded() && contains(text.out, "exact keys")) << text;
    EXPECT_TRUE(contains(text.out, std::to_string(fs::file_size("creature.throng")) + " bytes")) << text;
    fs::remove("creature.throng");
}

TEST_F(CliCompile, ClipsOfOtherFilesAreAdded) {
    generate("other.glb", "--joints 30 --levels 9 --faces 200 --seed 2");
    const Json own = json_of("compile creature.glb -o creature.throng");
    const Json json = json_of("compile creature.glb --clips other.glb creature.glb -o creature.throng");
    EXPECT_EQ(json["clips_from"], Json({"other.glb", "creature.glb"}));
    const size_t count = own["clips"].size();
    ASSERT_EQ(json["clips"].size(), 3 * count);
    for (size_t i = 0; i < count; ++i) {
        const std::string name = own["clips"][i]["name"];
        EXPECT_EQ(json["clips"][i]["name"], name);
        EXPECT_EQ(json["clips"][count + i]["name"], "other " + name);
        EXPECT_EQ(json["clips"][2 * count + i]["name"], "creature " + name);
    }
    EXPECT_TRUE(json["warnings"].empty());
    const auto pose = [&](const std::string& clip) {
        return json_of({"pose", "creature.throng", "--time", "0.4", "--vertices", "all", "--clip", clip});
    };
    const Json walk = pose("walk");
    EXPECT_GT(walk["primitives"].at(0)["positions"].size(), 100u);
    EXPECT_EQ(walk["skins"].at(0)["skinMatrix"].size(), 30u);
    EXPECT_TRUE(pose("creature walk") == walk);
    EXPECT_FALSE(pose("other walk")["skins"] == walk["skins"]);
    fs::remove("creature.throng");
    fs::remove("other.glb");
}

TEST_F(CliCompile, MeshesOfOtherFilesAreAdded) {
    const auto sections = [&](const std::string& more) {
        const Json json = json_of("compile creature.glb -o creature.throng" + more);
        EXPECT_TRUE(json["warnings"].empty());
        EXPECT_EQ(json["meshes_from"].size(), more.empty() ? 0u : 1u);
        return json_of({"pose", "creature.throng", "--vertices", "all"})["primitives"].size();
    };
    const size_t own = sections("");
    EXPECT_EQ(sections(" --meshes creature.glb"), 2 * own);
    fs::remove("creature.throng");
}

// Compiled characters are kept and reused while the file is the same; damaged ones are compiled again.
TEST_F(CliCompile, CompiledCharactersAreCached) {
    const fs::path cache = file("cache"), kept = cache / "throng" / "characters";
    const RunSettings with_cache{.environment = {{"XDG_CACHE_HOME", cache.string()}}};
    const auto count = [&] {
        std::error_code none;
        return std::distance(fs::directory_iterator(kept, none), fs::directory_iterator());
    };
    const auto write = [](const fs::path& path, const std::string& content) {
        std::ofstream(path, std::ios::binary) << content;
    };
    const auto pose = [&](const std::string& of) {
        const Outcome outcome = run_tool("pose " + of + " --clip 0 --time 0.3 --json", with_cache);
        EXPECT_TRUE(outcome.succeeded()) << outcome;
        return outcome.out;
    };
    ASSERT_TRUE(run_tool("generate --joints 30 --levels 8 --faces 300 --out kept.glb").succeeded());
    const std::string wanted = pose("kept.glb");
    ASSERT_EQ(count(), 1);
    EXPECT_EQ(pose("kept.glb"), wanted);
    EXPECT_EQ(count(), 1);
    const fs::path one = fs::directory_iterator(kept)->path();
    // The kept file is what is read: replacing it with another changes the result.
    const std::string was = read_file(one);
    ASSERT_TRUE(run_tool("generate --joints 31 --levels 8 --faces 300 --seed 3 --out other.glb").succeeded());
    ASSERT_TRUE(run_tool("compile other.glb --out other.throng").succeeded());
    fs::copy_file("other.throng", one, fs::copy_options::overwrite_existing);
    EXPECT_NE(pose("kept.glb"), wanted);
    write(one, was.substr(0, was.size() / 2));
    EXPECT_EQ(pose("kept.glb"), wanted);
    EXPECT_EQ(read_file(one), was);
    // The same name with different content, and different settings.
    fs::copy_file("other.glb", "kept.glb", fs::copy_options::overwrite_existing);
    EXPECT_NE(pose("kept.glb"), wanted);
    EXPECT_EQ(count(), 2);
    EXPECT_TRUE(run_tool("pose kept.glb --clip 0 --error 0.1 --json", with_cache).succeeded());
    EXPECT_EQ(count(), 3);
    // Different content of the same size.
    std::string renamed = read_file("kept.glb");
    const size_t name = renamed.find("\"idle\"");
    ASSERT_NE(name, std::string::npos);
    renamed[name + 1] = 'I';
    write("kept.glb", renamed);
    pose("kept.glb");
    EXPECT_EQ(count(), 4);
    // A command does not fail because something stands in the cache folder's place. (Mesa complains about it.)
    fs::remove_all(cache);
    write(cache, "no folder");
    EXPECT_EQ(run_tool("pose kept.glb --clip 0 --json", with_cache).exit_code, 0);
}

TEST_F(CliCompile, WrongInputIsRefusedAndNothingIsLeftBehind) {
    succeed("compile creature.glb -o sound.throng");
    std::string bytes = read_file("sound.throng");
    bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
    write("damaged.throng", bytes);
    bytes[8] = 5;
    write("newer.throng", bytes);
    write("cut.throng", bytes.substr(0, 5) + '\0');
    write("text.glb", "This is not glTF.\n");
    fs::copy_file("sound.throng", "taken.throng");
    fs::create_directory("folder");
    ASSERT_EQ(::mkfifo("pipe", 0600), 0);
    const std::string source_before = read_file("creature.glb"), compiled_before = read_file("sound.throng");
    expect_refused(
        {{"compile", "file"},
         {"compile creature.glb", "--out"},
         {"compile missing.glb -o out.throng", "missing.glb"},
         {"compile folder -o out.throng", "folder"},
         {"compile text.glb -o out.throng", "text.glb"},
         {"compile text.glb -o sound.throng", "text.glb"},
         {"compile creature.glb -o nowhere/out.throng", "nowhere"},
         {"compile creature.glb -o folder", "folder"},
         {"compile creature.glb -o /dev/null", "/dev/null"},
         {{"compile", "creature.glb", "-o", ""}, "the name of the file is empty"},
         {{"compile", "creature.glb", "-o", std::string(300, 'x')}, "File name too long"},
         {{"compile", "creature.glb", "-o", "no\nfolder/x"}, "no?folder/x cannot be written"},
         {"compile pipe -o out.throng", "pipe: not a regular file"},
         {"info pipe", "pipe: not a regular file"},
         {"compile creature.glb -o creature.glb", "would overwrite creature.glb"},
         {"compile sound.throng -o out.throng", "compiled already"},
         {"compile creature.glb -o out.throng --clips missing.glb", "missing.glb"},
         {"compile creature.glb -o out.throng --clips text.glb", "text.glb"},
         {"compile creature.glb -o out.throng --meshes missing.glb", "missing.glb"},
         {"compile creature.glb --meshes taken.throng -o taken.throng", "would overwrite taken.throng"},
         {"compile creature.glb -o out.throng --clips sound.throng", "sound.throng is compiled already"},
         {"compile creature.glb --clips taken.throng -o taken.throng", "would overwrite taken.throng"},
         {"compile damaged.throng -o out.throng", "damaged.throng: is damaged"},
         {"compile newer.throng -o out.throng", "newer.throng: has version 5, but this throng reads version 4"},
         {"compile creature.glb -o text.glb", "text.glb exists and is not a compiled character"},
         {"compile creature.glb -o out.throng --error 0", "--error"},
         {"compile creature.glb -o out.throng --error -1", "-1"},
         {"compile creature.glb -o out.GLB", "out.GLB: the output is not a glTF file"},
         {"compile creature.glb -o out.throng --error 11", "'11'"},
         {"compile creature.glb -o out.throng --error nan", "'nan'"},
         {"compile creature.glb -o out.throng --error 1x", "'1x'"},
         {{"compile", "creature.glb", "-o", "out.throng", "--error", ""}, "--error"},
         {"info damaged.throng", "damaged.throng: is damaged"},
         {"pose damaged.throng", "damaged.throng: is damaged"},
         {"render damaged.throng --out picture.png", "damaged.throng: is damaged"},
         {"bench damaged.throng", "damaged.throng: is damaged"},
         {"info sound.throng --error 0.01", "sound.throng is compiled already"},
         {"pose sound.throng --error exact", "sound.throng is compiled already"},
         {"render creature.glb sound.throng --error 1 --out picture.png", "sound.throng is compiled already"},
         {"bench sound.throng --error 1", "sound.throng is compiled already"},
         {"bench frame sound.throng --error 1", "sound.throng is compiled already"},
         {"compile sound.throng -o out.throng --error 1", "sound.throng is compiled already"},
         {"compile creature.glb -o out.throng --root-motion nobody", "there is no joint 'nobody'"},
         {"info sound.throng --root-motion spine", "sound.throng is compiled already, with its own root motion"},
         {"info newer.throng", "newer.throng: has version 5, but this throng reads version 4"},
         {"info cut.throng", "cut.throng"}});
    EXPECT_EQ(read_file("creature.glb"), source_before);
    EXPECT_EQ(read_file("sound.throng"), compiled_before);
    EXPECT_TRUE(fs::is_empty("folder"));
}

}  // namespace
}  // namespace throng
