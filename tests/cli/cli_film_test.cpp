// Films from the command line: frames that are kept, shared among runs, or refused, and the encoded film.
#include "tests/glb_builder.h"
#include "tests/text.h"
#include "tests/tool_runner.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fcntl.h>
#include <fstream>
#include <future>
#include <map>
#include <mutex>
#include <numeric>
#include <regex>
#include <set>
#include <sys/file.h>
#include <unistd.h>
#include <utility>

#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#define STBI_ONLY_PNG
#include <stb/stb_image.h>

namespace throng {
namespace {

using namespace test;
namespace fs = std::filesystem;

// Two creatures, one with a controller. Films have frames 0 to 3, tiny and a second apart, so that parameters change
// between frames.
class CliFilm : public ToolTest {
protected:
    static void SetUpTestSuite() {
        ToolTest::SetUpTestSuite();
        for (const std::string kind : {"walker", "dragon"})
            generate(kind + ".glb", kind + " --joints 50 --levels 12 --faces 600");
    }

    static Words arguments(const std::string& out) {
        return "render walker.glb dragon.glb --count 6 --placement disc --camera flyover:seconds=5 --size 64x36 "
               "--frames 0:4 --fps 1" +
               Words{"--controller", "walker.glb=" THRONG_SOURCE_DIR "/examples/controllers/walker.json", "--out", out};
    }
    static Outcome film(const std::string& out, const Words& more = {}) { return run_tool(arguments(out) + more); }
    // The same, but with another value of one option.
    static Outcome film_with(const std::string& out, const std::string& option, const std::string& value) {
        Words all = arguments(out);
        const auto there = std::find(all.begin(), all.end(), option);
        if (there == all.end()) return run_tool(all + Words{option, value});
        *(there + 1) = value;
        return run_tool(all);
    }
    // One frame.
    static Words short_film(const std::string& out) {
        return "render walker.glb --size 64x36 --frames 0:1" + Words{"--out", out};
    }
    // With an ffmpeg that writes a word to its output file and then runs `then`.
    static RunSettings with_ffmpeg(const std::string& then) {
        const std::string program = write("bin/ffmpeg",
                                          "#!/bin/sh\nfor out; do :; done\n[ \"$out\" != -version ] || exit 0\n"
                                          "printf pictures >\"$out\"\n" +
                                              then);
        fs::permissions(program, fs::perms::owner_all);
        return {.environment = {{"PATH", file("bin") + ":" + std::getenv("PATH")}}};
    }
    static std::map<std::string, std::string> contents(const std::string& folder) {
        std::map<std::string, std::string> files;
        for (const auto& entry : fs::directory_iterator(folder))
            files[entry.path().filename()] = read_file(entry.path());
        return files;
    }
    static std::string new_folder(const std::string& name) {
        fs::create_directory(name);
        return name;
    }
};

TEST_F(CliFilm, AFrameDoesNotDependOnWhichOthersAreDrawn) {
    const std::string whole = new_folder("whole"), shared = new_folder("shared"), resumed = new_folder("resumed");
    const Outcome run = film(whole + "/frame_%04d.png", "--json");
    ASSERT_TRUE(run.succeeded()) << run;
    const Json json = Json::parse(run.out);
    EXPECT_EQ(json["frames"], 4);
    EXPECT_EQ(json["rendered"], 4);
    EXPECT_GT(json["stages_ms"]["skin+draw"], 0);
    const std::vector<uint32_t> drawn = json["drawn"];
    EXPECT_GT(std::accumulate(drawn.begin(), drawn.end(), 0u), 0u);
    EXPECT_LE(std::accumulate(drawn.begin(), drawn.end(), 0u), 6u);
    const auto frames = contents(whole);
    ASSERT_EQ(frames.size(), 5u);
    EXPECT_NE(frames.at("frame_0000.png"), frames.at("frame_0003.png"));

    ASSERT_TRUE(film(shared + "/frame_%04d.png", "--shard 1/2").succeeded());
    EXPECT_EQ(contents(shared).size(), 3u);  // frames 1 and 3, and the settings
    ASSERT_TRUE(film(shared + "/frame_%04d.png", "--shard 0/2").succeeded());
    EXPECT_EQ(contents(shared), frames);

    // An interrupted run left some frames; one is damaged, and one has another size.
    for (const char* kept : {"frame_settings.json", "frame_0001.png", "frame_0002.png", "frame_0003.png"})
        fs::copy_file(whole + "/" + kept, resumed + "/" + kept);
    fs::resize_file(resumed + "/frame_0002.png", frames.at("frame_0002.png").size() / 2);
    const auto time = fs::last_write_time(resumed + "/frame_0001.png");
    const Outcome again = film(resumed + "/frame_%04d.png", "--json");
    ASSERT_TRUE(again.succeeded()) << again;
    EXPECT_EQ(Json::parse(again.out)["kept"], 2);
    EXPECT_EQ(contents(resumed), frames);
    EXPECT_EQ(fs::last_write_time(resumed + "/frame_0001.png"), time);
    const Json nothing_new = json_of(arguments(resumed + "/frame_%04d.png"));
    EXPECT_EQ(nothing_new["rendered"], 0);
    EXPECT_TRUE(nothing_new["stages_ms"].is_null()) << nothing_new;

    // A still picture at that time equals the frame.
    Words picture = arguments("picture.png");
    const auto first = std::find(picture.begin(), picture.end(), "--frames");
    picture.erase(first, first + 4);  // with --fps
    succeed(picture);
    EXPECT_EQ(read_file("picture.png"), frames.at("frame_0000.png"));
}

// Steered characters have walked equally far in a frame whether or not the frames before it are drawn.
TEST_F(CliFilm, SteeredCharactersDoNotDependOnDrawnFrames) {
    const std::string whole = new_folder("walked"), shared = new_folder("walked_unseen");
    ASSERT_TRUE(film(whole + "/%d.png", "--steer --spacing 2").succeeded());
    ASSERT_TRUE(film(shared + "/%d.png", "--steer --spacing 2 --shard 3/4").succeeded());
    EXPECT_EQ(contents(shared).at("3.png"), contents(whole).at("3.png"));
    EXPECT_TRUE(film(whole + "/%d.png", "--spacing 2").refused("steer true, not false"));
}

TEST_F(CliFilm, FramesOfOtherSettingsAreRefused) {
    const std::string folder = new_folder("settings"), out = folder + "/%d.png";
    ASSERT_TRUE(film(out, "--shard 3/4").succeeded());
    const auto before = contents(folder);
    const std::map<std::string, std::pair<std::string, std::string>> others{
        {"--count", {"7", "counts [3,3], not [3,4]"}},
        {"--sizes", {"1,2", "sizes [], not [1.0,2.0]"}},
        {"--placement", {"grid", "placement"}},
        {"--spacing", {"2", "spacing 1.0, not 2.0"}},
        {"--controller", {THRONG_SOURCE_DIR "/examples/controllers/walker.json", "controllers"}},
        {"--looks", {"dragon.glb=" THRONG_SOURCE_DIR "/examples/looks/dragon.json", "looks"}},
        {"--clip", {"dragon.glb=0", "clips"}},
        {"--seed", {"2", "seed 1, not 2"}},
        {"--scan", {"serial", "scan"}},
        {"--path", {"fused", "path 0, not 1"}},
        {"--error", {"exact", "error"}},
        {"--size", {"32x36", "size"}},
        {"--time", {"2", "time 0.0, not 2.0"}},
        {"--camera", {"fit", "camera"}},
        {"--fps", {"2", "fps 1.0, not 2.0"}},
        {"--skinning", {"dual-quaternion", "skinning"}},
        {"--own-poses", {"5", "own-poses 0, not 5"}},
        {"--lod-pixels", {"2", "lod-pixels 1.0, not 2.0"}}};
    for (const auto& [option, other] : others)
        EXPECT_TRUE(film_with(out, option, other.first).refused(other.second)) << option;
    const std::vector<std::string> flags{"everything", "skeletons", "bounds", "steer", "skin-once"};
    for (const std::string& flag : flags)
        EXPECT_TRUE(film(out, {"--" + flag}).refused(flag + " false, not true")) << flag;
    EXPECT_TRUE(film(out, {"--clip", "dragon.glb=0", "--blend", "dragon.glb=1"}).refused("blends"));
    Words replaced = arguments(out);
    *std::find(replaced.begin(), replaced.end(), "--count") = "--counts";
    *(std::find(replaced.begin(), replaced.end(), "--counts") + 1) = "4,2";
    EXPECT_TRUE(run_tool(replaced).refused("count"));
    const auto camera = std::find(replaced.begin(), replaced.end(), "--camera");
    replaced.insert(replaced.erase(camera, camera + 2), {"--eye", "1,2,3", "--target", "0,1,0"});
    EXPECT_TRUE(run_tool(replaced).refused("made with"));
    // No option is forgotten: those named here, in addition to `others`, change no frame.
    std::set<std::string> known{"--help", "--frames", "--shard", "--out",    "--device",
                                "--json", "--counts", "--eye",   "--target", "--renderer"};
    known.insert({"--blend", "--weight", "--force"});
    for (const std::string& flag : flags) known.insert("--" + flag);
    for (const auto& [option, other] : others) known.insert(option);
    const std::string help = run_tool("render --help").out;
    const std::regex option("\n  (?:-.,)?(--[a-z-]+)");
    for (std::sregex_iterator found(help.begin(), help.end(), option), end; found != end; ++found)
        EXPECT_TRUE(known.contains((*found)[1])) << (*found)[1] << ": is it in the settings of films?";

    Json settings = Json::parse(before.at("settings.json"));
    ASSERT_EQ(settings["updates"].size(), 2u);
    EXPECT_NE(settings["updates"][0].get<std::string>().find("fused, "), std::string::npos) << settings;
    settings["updates"][1] = "staged, serial";
    std::ofstream(folder + "/settings.json") << settings;
    EXPECT_TRUE(film(out).refused("updates")) << "another scan chosen, as by the costs of throng tune";
    settings = Json::parse(before.at("settings.json"));
    const std::string renderer = settings["renderer"];
    if (renderer.starts_with("native ")) {
        EXPECT_TRUE(film_with(out, "--renderer", "vulkan").refused("renderer \"" + renderer + "\", not \"vulkan\""));
        EXPECT_TRUE(settings["updates"][0].get<std::string>().ends_with(renderer.substr(7))) << settings;
    }
    settings["renderer"] = "native MMX";
    std::ofstream(folder + "/settings.json") << settings;
    EXPECT_TRUE(film(out).refused("renderer \"native MMX\", not \"" + renderer)) << "of another instruction set";
    std::ofstream(folder + "/settings.json") << before.at("settings.json");
    fs::remove(folder + "/3.png");
    EXPECT_TRUE(film(out, "--seed 2").refused("seed 1, not 2")) << "of a shard that has drawn nothing yet";
    std::ofstream(folder + "/3.png") << before.at("3.png");
    fs::remove(folder + "/settings.json");
    EXPECT_TRUE(film(out).refused("3.png"));
    std::ofstream(folder + "/settings.json") << "no settings";
    EXPECT_TRUE(film(out).refused("settings.json"));
    EXPECT_EQ(contents(folder).at("3.png"), before.at("3.png"));
}

// The character moves at 2 m/s. The camera follows its position in the frame, not its position before the step.
TEST_F(CliFilm, TheCameraFollowsRootMotion) {
    GlbBuilder mover = tiny_character();
    const size_t places = mover.add<float>({0, 0, 0, 0, 0, 2}, "VEC3", kFloat);
    mover.json["animations"] = {{{"name", "go"},
                                 {"channels", {{{"sampler", 0}, {"target", {{"node", 1}, {"path", "translation"}}}}}},
                                 {"samplers", {{{"input", kTimes}, {"output", places}}}}}};
    mover.json["materials"] = {
        {{"doubleSided", true}, {"pbrMetallicRoughness", {{"baseColorFactor", {0.9, 0, 0, 1}}}}}};
    mover.json["meshes"][0]["primitives"][0]["material"] = 0;
    std::ofstream("mover.glb", std::ios::binary) << mover.glb();
    std::ofstream("go.json") << R"({"layers": [{"name": "body", "states": {"go": {"clip": "go"}}}]})";
    const Outcome compiled = succeed("compile mover.glb --root-motion root --out mover.throng");
    const std::string folder = new_folder("followed");
    const Outcome run = succeed(
        "render mover.throng --controller go.json --camera follow --size 64x36 --time 2 --frames 0:2 "
        "--fps 1000 --out " +
        folder + "/%d.png");
    int red = 0, other = 0;
    const auto pixels = [&](const char* frame) {
        int width = 0, height = 0;
        const std::unique_ptr<stbi_uc, decltype(&stbi_image_free)> read(
            stbi_load((folder + frame).c_str(), &width, &height, nullptr, 3), &stbi_image_free);
        EXPECT_TRUE(read && width == 64 && height == 36);
        return std::vector<int>(read.get(), read.get() + 64 * 36 * 3);
    };
    const std::vector<int> after_two_s = pixels("/0.png"), after_a_ms = pixels("/1.png");
    for (size_t i = 0; i < after_two_s.size(); i += 3) {
        red += after_a_ms[i] > 2 * after_a_ms[i + 1];
        other += std::abs(after_two_s[i + 1] - after_a_ms[i + 1]) > 24;
    }
    EXPECT_GT(red, 20);
    EXPECT_LE(other, red / 20);
}

TEST_F(CliFilm, AFilmContainsAllItsFrames) {
    if (std::system("ffmpeg -version >/dev/null 2>&1") != 0) GTEST_SKIP() << "no ffmpeg";
    const std::string out = "100 % film.mp4";
    ASSERT_TRUE(film(out, "--shard 0/2").succeeded());
    EXPECT_FALSE(fs::exists(out));
    EXPECT_TRUE(fs::exists(out + ".frames/000002.png"));
    const Outcome run = film(out, "--json");
    ASSERT_TRUE(run.succeeded()) << run;
    EXPECT_EQ(Json::parse(run.out)["kept"], 2);
    EXPECT_FALSE(fs::exists(out + ".frames"));
    const std::string probed = "probed.txt", probe =
                                                 "ffprobe -v error -count_frames -show_entries "
                                                 "stream=nb_read_frames,width,height,r_frame_rate -of csv=p=0 '" +
                                                 out + "' >'" + probed + "'";
    ASSERT_EQ(std::system(probe.c_str()), 0);
    EXPECT_EQ(read_file(probed), "64,36,1/1,4\n");

    const std::string before = read_file(out);
    EXPECT_TRUE(film(out, "--clip dragon.glb=0").refused("the film exists already; --force"));
    EXPECT_EQ(read_file(out), before);
    EXPECT_TRUE(film(out, "--clip dragon.glb=0 --force").succeeded());
    EXPECT_NE(read_file(out), before);
}

// Where SIGCHLD is ignored, the system does not tell how a child process ended.
TEST_F(CliFilm, AFailingEncoderIsNoticedIfSigchldIsIgnored) {
    const std::string folder = new_folder("ignored"), out = folder + "/film.mp4";
    RunSettings settings = with_ffmpeg("echo no room >&2; exit 1");
    settings.program = "env";
    const Outcome outcome = run_tool(Words{"--ignore-signal=CHLD", THRONG_TOOL} + short_film(out), settings);
    EXPECT_TRUE(outcome.refused("film.mp4: ffmpeg: no room")) << outcome;
    EXPECT_TRUE(fs::exists(out + ".frames/000000.png")) << "frames are kept until there is a film of them";
    EXPECT_EQ(std::distance(fs::directory_iterator(folder), {}), 1) << "no half of a film";
}

TEST_F(CliFilm, NoLinkIsFollowedToWriteAFilm) {
    const std::string folder = new_folder("links"), out = folder + "/film.mp4", other = write("links/other", "other");
    RunSettings settings = with_ffmpeg("");
    fs::create_symlink(other, out + ".lock");
    const Outcome refused = run_tool(short_film(out), settings);
    EXPECT_TRUE(refused.refused("film.mp4.lock: is a symbolic link")) << refused;
    EXPECT_EQ(read_file(other), "other");
    fs::remove(out + ".lock");

    bool are_linked = false;
    settings.watch = [&](int process, const std::string&) {
        if (std::exchange(are_linked, true)) return;
        for (const std::string end : {"", ".0"})
            fs::create_symlink(other, out + ".part" + std::to_string(process) + end);
    };
    const Outcome drawn = run_tool(short_film(out), settings);
    EXPECT_TRUE(drawn.succeeded()) << drawn;
    EXPECT_EQ(read_file(other), "other");
    EXPECT_FALSE(fs::is_symlink(out));
    EXPECT_EQ(read_file(out), "pictures");
}

// Both processes wait until the film's lock is free. Then one draws, and the other finds all its frames there.
TEST_F(CliFilm, TwoProcessesDoNotDrawTheSameFrames) {
    const std::string folder = new_folder("at_once");
    for (const auto& [name, lock] :
         {std::pair{"/frame_%d.png", "/frame_settings.json.lock"}, {"/film.mp4", "/film.mp4.lock"}}) {
        const std::string out = folder + name;
        int held = open((folder + lock).c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
        ASSERT_EQ(flock(held, LOCK_EX), 0);
        std::mutex mutex;
        std::set<int> waiting;
        const auto release_lock = [&] {
            if (held >= 0) close(std::exchange(held, -1));
        };
        const auto release_when_both_wait = [&](int process, const std::string& err) {
            const std::lock_guard guard(mutex);
            if (contains(err, "waiting for it")) waiting.insert(process);
            if (waiting.size() == 2) release_lock();
        };
        const auto draw = [&] {
            const Outcome outcome = run_tool(arguments(out) + Words{"--json"}, {.watch = release_when_both_wait});
            const std::lock_guard guard(mutex);
            release_lock();  // if it has not waited, the other process must not wait forever
            return outcome;
        };
        std::future<Outcome> other = std::async(std::launch::async, draw);
        const std::array outcomes{draw(), other.get()};
        std::multiset<int> rendered;
        for (const Outcome& outcome : outcomes) {
            ASSERT_EQ(outcome.exit_code, 0) << outcome;
            const Json json = Json::parse(outcome.out);
            EXPECT_EQ(json["frames"], 4);
            rendered.insert(json["rendered"].get<int>());
        }
        EXPECT_EQ(waiting.size(), 2u);
        EXPECT_EQ(rendered, (std::multiset{0, 4})) << out;
    }
    std::set<std::string> names;
    for (const auto& [name, content] : contents(folder)) names.insert(name);
    EXPECT_EQ(names, (std::set<std::string>{"film.mp4", "frame_0.png", "frame_1.png", "frame_2.png", "frame_3.png",
                                            "frame_settings.json"}));
}

// Shards hold the lock together; a run of all frames holds it exclusively.
TEST_F(CliFilm, ShardsAndFullRunsWaitForEachOther) {
    const std::string folder = new_folder("beside"), lock = folder + "/settings.json.lock";
    const Words all = "render walker.glb --size 64x36 --frames 0:2" + Words{"--out", folder + "/%d.png"},
                shard = all + "--shard 0/2";
    int held = -1;
    const auto take_lock = [&](int operation) {
        held = open(lock.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
        ASSERT_EQ(flock(held, operation), 0);
    };
    const auto release_lock = [&] {
        if (held >= 0) close(std::exchange(held, -1));
    };
    const auto release_when_it_waits = [&](int, const std::string& err) {
        if (contains(err, "waiting for it")) release_lock();
    };
    take_lock(LOCK_SH);
    const Outcome beside_another = run_tool(shard, {.time_limit_s = 20});
    EXPECT_TRUE(beside_another.succeeded()) << beside_another;
    EXPECT_TRUE(fs::exists(lock)) << "another one holds it still";
    release_lock();
    for (const auto& [operation, command] : {std::pair{LOCK_EX, shard}, {LOCK_SH, all}}) {
        take_lock(operation);
        const Outcome outcome = run_tool(command, {.time_limit_s = 20, .watch = release_when_it_waits});
        EXPECT_EQ(outcome.exit_code, 0) << outcome;
        EXPECT_TRUE(contains(outcome.err, "waiting for it")) << outcome;
        release_lock();
        EXPECT_FALSE(fs::exists(lock)) << "nobody holds it any more";
    }
}

TEST_F(CliFilm, AFilmOfAnotherProcessIsNotMistakenForThisOne) {
    const std::string folder = new_folder("meanwhile"), out = folder + "/film.mp4", lock = out + ".lock";
    int held = open(lock.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    ASSERT_EQ(flock(held, LOCK_EX), 0);
    ASSERT_EQ(pwrite(held, "others", 6, 0), 6);
    const auto draw_other = [&](int, const std::string& err) {
        if (held < 0 || !contains(err, "waiting for it")) return;
        std::ofstream(out) << "a film";
        fs::remove(lock);
        close(std::exchange(held, -1));
    };
    const Outcome outcome = run_tool(arguments(out), {.watch = draw_other});
    EXPECT_EQ(outcome.exit_code, 1) << outcome;
    EXPECT_TRUE(contains(outcome.err, "another process has just drawn a different film there")) << outcome;
    EXPECT_EQ(read_file(out), "a film");
    EXPECT_FALSE(fs::exists(lock));
}

TEST_F(CliFilm, AnInterruptionBeforeTheFirstFrameIsReported) {
    const std::string folder = new_folder("early"), out = folder + "/film.mp4";
    int calls = 0;
    const auto interrupt = [&](int process, const std::string&) {
        if (fs::exists(out + ".lock") && ++calls == 3) kill(process, SIGINT);
    };
    const Outcome outcome = run_tool(arguments(out), {.watch = interrupt});
    EXPECT_TRUE(outcome.refused("interrupted before the first of 4 frames")) << outcome;
    EXPECT_TRUE(fs::is_empty(folder));
}

TEST_F(CliFilm, AnInterruptedFilmReportsTheKeptFrames) {
    const std::string folder = new_folder("interrupted"), out = folder + "/%d.png";
    bool is_drawing = true;
    const auto interrupt_after_a_frame = [&](int process, const std::string&) {
        if (is_drawing && fs::exists(folder + "/0.png")) is_drawing = kill(process, SIGINT) != 0;
    };
    const Words command = "render walker.glb --size 640x360 --frames 0:500" + Words{"--out", out};
    const Outcome interrupted = run_tool(command, {.watch = interrupt_after_a_frame});
    EXPECT_TRUE(interrupted.refused("interrupted; ")) << interrupted;
    EXPECT_TRUE(interrupted.refused("the same command draws the others")) << interrupted;
    std::smatch kept;
    ASSERT_TRUE(std::regex_search(interrupted.err, kept, std::regex("([0-9]+) of 500 frames")));
    const auto count = static_cast<size_t>(std::stoul(kept[1]));
    EXPECT_GT(count, 0u);
    EXPECT_EQ(contents(folder).size(), count + 1) << "with the settings, and nothing half-written";
}

TEST_F(CliFilm, ALongFilmSaysBeforehandHowLongItWillTake) {
    const std::string folder = new_folder("long");
    bool is_drawing = true;
    const auto interrupt_after_some_frames = [&](int process, const std::string&) {
        if (is_drawing && fs::exists(folder + "/3.png")) is_drawing = kill(process, SIGINT) != 0;
    };
    const Words command = "render walker.glb --size 640x360 --frames 0:500000" + Words{"--out", folder + "/%d.png"};
    const Outcome interrupted = run_tool(command, {.watch = interrupt_after_some_frames});
    EXPECT_TRUE(std::regex_search(interrupted.err, std::regex("500000 frames will take about [0-9]+ (min|h)")))
        << interrupted;
}

// There are two thousand frames to check, so the signal arrives long before the last one is decoded.
TEST_F(CliFilm, AnInterruptionEndsTheCheckOfExistingFrames) {
    const std::string folder = new_folder("checked"), lock = folder + "/settings.json.lock";
    const auto command = [&](const std::string& frames) {
        return "render walker.glb --size 1280x720 --frames" + Words{frames, "--out", folder + "/%d.png"};
    };
    succeed(command("0:1"));
    for (int frame = 1; frame < 2000; ++frame)
        fs::create_hard_link(folder + "/0.png", folder + "/" + std::to_string(frame) + ".png");
    bool is_asked = false;
    const auto interrupt = [&](int process, const std::string&) {
        std::error_code none;
        if (!is_asked && fs::file_size(lock, none) > 0 && !none) is_asked = kill(process, SIGINT) == 0;
    };
    const Outcome outcome = run_tool(command("0:2000"), {.watch = interrupt});
    EXPECT_TRUE(outcome.refused("interrupted while checking the 2000 frames that exist")) << outcome;
}

TEST_F(CliFilm, UnknownFilesOfControllersAreRefused) {
    EXPECT_TRUE(film("%d.png", "--controller cat.glb=cat.json").refused("cat.glb"));
    EXPECT_TRUE(film("%d.png", "--controller missing.json").refused("missing.json"));
    EXPECT_TRUE(film("%d.png", {"--controller", "dragon.glb=" THRONG_SOURCE_DIR "/examples/controllers/willow.json"})
                    .refused("gust"));
}

TEST_F(CliFilm, WrongOptionsAreRefused) {
    const auto with = [&](const std::string& option, const std::string& value) {
        return film_with("%d.png", option, value);
    };
    const std::map<std::string, std::vector<std::string>> wrong{
        {"--frames", {"4", "4:", ":4", "4:4", "5:4", "0:4:1", "0:1000001", "0:99999999999"}},
        {"--shard", {"1", "2/2", "0/0", "/2", "1/", "a/b"}},
        {"--fps", {"0", "-1", "nan", "many", "1e9"}},
        {"--placement", {"heap"}},
        {"--spacing", {"0"}},
        {"--sizes", {"1", "0,1", "0.001,100000"}},
        {"--counts", {"1,2"}},
        {"--eye", {"1,2,3"}}};
    for (const auto& [option, values] : wrong)
        for (const std::string& value : values)
            EXPECT_TRUE(with(option, value).refused(option)) << option << " " << value;
    for (const char* name : {"frame.png", "frame_%4d.png", "frame_%s.png", "%d_%d.png", "frame_%0999d.png",
                             "frame_%d.jpg", "film.avi", "nowhere/%d.png"})
        EXPECT_TRUE(with("--out", name).refused(name)) << name;
    EXPECT_TRUE(with("--camera", "spin").refused("--camera spin"));
    EXPECT_TRUE(with("--camera", "follow:character=6").refused("character 6"));

    Words odd = arguments("odd.mp4");
    *(std::find(odd.begin(), odd.end(), "--size") + 1) = "63x36";
    expect_refused({{odd, "63x36"},
                    {"render walker.glb --out still.mp4", "--frames"},
                    {"render walker.glb --fps 24 --out still.png", "--fps"},
                    {"render walker.glb --counts 1,2 --out still.png", "--counts"},
                    {"render walker.glb --counts 0 --out still.png", "--counts"},
                    {"render walker.glb --eye 0,1,2 --target 0,1,2 --out still.png",
                     "--eye and --target: they must be different points"}});
    const RunSettings no_programs{.environment = {{"PATH", "/nowhere"}}};
    EXPECT_TRUE(run_tool(arguments("film.mp4"), no_programs).refused("ffmpeg"));
}

}  // namespace
}  // namespace throng
