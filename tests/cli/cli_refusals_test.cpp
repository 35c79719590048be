// One clear line for each error of a user, a file or the machine.
#include "tests/cli/cli_cases.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>

namespace throng {
namespace {

using namespace test;
namespace fs = std::filesystem;

class CliRefusals : public ToolTestWithCreature {};

TEST_F(CliRefusals, WrongInputIsRefusedInOneLineThatNamesIt) {
    write("empty.glb", "");
    write("text.glb", "This is not glTF.\n");
    write("json.gltf", "{\"hello\": 1}\n");
    fs::create_directory("folder");
    expect_refused({
        {{}, "command"},
        {"dance", "there is no command 'dance'. There are: info, compile"},
        {"rendr creature.glb", "there is no command 'rendr'; did you mean 'render'?"},
        {"render creature.glb --out x.png --cont 5", "--cont; did you mean --count? (throng render --help)"},
        {"render creature.glb --out x.png --placement circle", "'circle' is not one of disc, grid, path, random"},
        {"render creature.glb --out x.png --count abc", "'abc' is not a whole number from 1 to 10000000"},
        {"render creature.glb --out x.png --spacing 1x", "'1x' is not a number from 0.1 to 100"},
        {"generate --joints -5 --out x.glb", "--joints: '-5' is not a number that this option can have"},
        {"generate --out x.png", "--out x.png: the output is a binary glTF file; give a name that ends in .glb"},
        {"info", "file"},
        {"info missing.glb", "missing.glb"},
        {"info folder", "folder"},
        {"info empty.glb", "empty.glb"},
        {"info text.glb", "text.glb"},
        {"info json.gltf", "json.gltf"},
        {"info creature.glb --colour", "--colour"},
        {"generate --out text.glb", "text.glb exists and is not a binary glTF file"},
        {"pose missing.glb", "missing.glb"},
        {"pose creature.glb --clip swim", "there is no clip 'swim'. There are: idle, walk, fly, glide, roar"},
        {"pose creature.glb --clip 5", "'5'"},
        {"pose creature.glb --clip -1", "-1"},
        {"pose creature.glb --time 3", "--time requires --clip"},
        {"pose creature.glb --loop", "--loop requires --clip"},
        {"pose creature.glb --blend walk", "--blend requires --clip"},
        {"pose creature.glb --clip walk --blend-time 1", "--blend-time requires --blend"},
        {"pose creature.glb --clip walk --weight 0.2", "--weight requires --blend"},
        {"pose creature.glb --clip walk --blend swim", "swim"},
        {"pose creature.glb --clip walk --time nan", "--time"},
        {"pose creature.glb --clip walk --time inf", "--time"},
        {"pose creature.glb --clip walk --time noon", "--time"},
        {"pose creature.glb --clip walk --blend fly --blend-time -inf", "--blend-time"},
        {"pose creature.glb --clip walk --blend fly --weight 2", "--weight"},
        {"pose creature.glb --clip walk --blend fly --weight nan", "--weight"},
        {"pose creature.glb --vertices some", "--vertices some"},
        {"pose creature.glb --vertices -1", "-1"},
        {"pose creature.glb --scan magic", "magic"},
        {"pose creature.glb --device abacus", "abacus"},
        {"render creature.glb", "--out"},
        {"render --out picture.png", "files"},
        {"render missing.glb --out picture.png", "missing.glb"},
        {"render creature.glb --out nowhere/picture.png", "nowhere/picture.png"},
        {"render creature.glb --out folder", "folder"},
        {"render creature.glb --out /dev/null", "/dev/null"},
        {"render creature.glb --out picture.png --size 12", "--size 12"},
        {"render creature.glb --out picture.png --size 0x10", "--size 0x10"},
        {"render creature.glb --out picture.png --size -5x10", "-5x10"},
        {"render creature.glb --out picture.png --size 10x10x10", "--size 10x10x10"},
        {"render creature.glb --out picture.png --size x", "--size x"},
        {"render creature.glb --out picture.png --size 4294967297x10", "--size 4294967297x10"},
        {"render creature.glb --out picture.png --size 1000000x1000000", "1000000"},
        {"render creature.glb --out picture.png --count 0", "--count"},
        {"render creature.glb --out picture.png --count -3", "--count"},
        {"render creature.glb --out picture.png --count many", "--count"},
        {"render creature.glb --out picture.png --time nan", "--time"},
        {"render creature.glb --out picture.png --time 1e300", "--time"},
        {"render creature.glb --out picture.png --device 99", "99"},
        {"render creature.glb --out picture.png --renderer metal", "--renderer"},
        {"generate --out nowhere/creature.glb", "nowhere/creature.glb"},
        {"generate unicorn --out none.glb", "there is no 'unicorn'. There are: dragon, willow, walker, centipede"},
        {"generate --joints 0 --out none.glb", "joints"},
        {"generate --joints -5 --out none.glb", "joints"},
        {"generate --joints 10 --levels 11 --out none.glb", "levels"},
        {"generate --faces 99999999 --out none.glb", "faces"},
        {"bench --count 0", "--count"},
        {"bench --samples 0", "--samples"},
        {"bench --scan magic", "magic"},
        {"bench --joints 5 --levels 9", "levels"},
        {"bench scan --methods magic", "magic"},
        {"bench scan --methods serial:3", "serial:3"},
        {"bench scan --methods serial:x", "serial:x"},
        {"bench scan --characters 0", "--characters"},
        {"bench scan --joints 10 --levels 11", "11 levels"},
        {"bench scan --levels 1", "1 levels"},
        {"bench scan --shape star", "star"},
        {"bench scan --experiments dance", "dance"},
        {"bench scan --samples -2", "--samples"},
        {"bench scan --json none/x.jsonl", "none"},
        {"bench scan creature.glb", "creature.glb"},
        {"bench cpu --isa mmx", "--isa"},
        {"bench cpu --threads 0", "--threads"},
        {"bench draw --isa mmx", "--isa"},
        {"bench draw creature.glb --size 0x9", "0x9"},
        {"bench frame --count 0", "--count"},
        {"bench frame --samples 0", "--samples"},
        {"bench frame --error 0", "--error"},
        {"bench frame --error nan", "--error"},
        {"bench frame --error 1x", "--error"},
        {"bench frame --report none/x.html", "none"},
        {"bench frame none.glb", "none.glb"},
        {"bench baselines --rate 0", "--rate"},
        {"bench baselines --levels 15 --rate 10000 --device cpu", "storage-buffer range"},
        {"bench baselines --json none/x.jsonl", "none"},
        {"devices all", "all"},
    });
    EXPECT_TRUE(fs::is_empty("folder"));
}

// Help says that 1 is the exit code of failures.
TEST_F(CliRefusals, AWrongOptionHasAnExitCodeOfItsOwn) {
    for (const char* command : {"render creature.glb --out x.png --cont 5", "pose creature.glb --vertices some",
                                "pose creature.glb --blend walk", "view creature.glb --size 1x1"})
        EXPECT_GT(run_tool(command).exit_code, 1) << command;
    EXPECT_EQ(run_tool("pose missing.glb").exit_code, 1);
}

TEST_F(CliRefusals, AFullDiskIsReported) {
    for (const char* option : {"--json", "--help"}) {
        const Outcome run = run_tool({"info", "creature.glb", option}, {.out_path = "/dev/full"});
        EXPECT_TRUE(run.refused("standard output")) << option << "\n" << run;
    }
}

// Wherever memory runs out while a file is read, the error says so.
TEST_F(CliRefusals, LackOfMemoryIsReported) {
    ASSERT_TRUE(run_tool({"generate", "--joints", "4000", "--levels", "100", "--out", "large.glb"}).succeeded());
    int refused = 0;
    for (uint64_t limit_MiB = 36; limit_MiB <= 100; limit_MiB += 4) {
        // Without the setting of ./run, malloc would reserve 64 MiB at a time
        const Outcome run = run_tool({"info", "large.glb"},
                                     {.environment = {{"GLIBC_TUNABLES", ""}}, .memory_limit_bytes = limit_MiB << 20});
        if (run.succeeded()) continue;
        EXPECT_TRUE(run.refused("out of memory")) << limit_MiB << " MiB\n" << run;
        ++refused;
    }
    EXPECT_GT(refused, 0);
}

// Broken and malicious files from other sources, and mutated valid files: each gives an answer or a refusal, never a
// crash, a hang or unbounded memory use.
TEST_F(CliRefusals, InvalidFilesAreAnsweredOrRefused) {
    const char* shared = std::getenv("THRONG_SHARED");
    const fs::path folder = fs::path(shared ? shared : THRONG_SHARED_DIR) / "invalid";
    if (!fs::exists(folder)) GTEST_SKIP() << folder << " is not there";
    constexpr uint64_t kMemory_bytes = (uint64_t{1} << 30) + (uint64_t{256} << 20);  // 1 GiB, and the program itself
    int answered = 0, refused = 0;
    double slowest_s = 0;
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
        const fs::path& path = entry.path();
        if (path.extension() != ".glb" && path.extension() != ".gltf") continue;
        const Outcome run = run_tool({"info", path.string()},
                                     {.memory_limit_bytes = kMemory_bytes, .time_limit_s = 20});
        if (run.succeeded() && !run.out.empty())
            ++answered;
        else if (run.refused(path.filename().string()) && run.out.empty())
            ++refused;
        else
            ADD_FAILURE() << path << "\n" << run;
        slowest_s = std::max(slowest_s, run.time_s);
    }
    EXPECT_GT(answered + refused, 0);
    std::printf("%d answered, %d refused; the slowest took %.2f s\n", answered, refused, slowest_s);
}

}  // namespace
}  // namespace throng
