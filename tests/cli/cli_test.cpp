// The command line for its users: what it prints and what it writes.
#include "bench/psnr.h"
#include "tests/cli/cli_cases.h"
#include "tests/png.h"
#include "tests/text.h"

#include <throng/version.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <set>
#include <string>

namespace throng {
namespace {

using namespace test;
namespace fs = std::filesystem;

// The largest difference between two JSON values of the same shape; infinite where the shapes differ.
double difference(const Json& a, const Json& b) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    if (a.is_number() && b.is_number()) return std::abs(a.get<double>() - b.get<double>());
    if (!a.is_array() || !b.is_array() || a.size() != b.size()) return kInfinity;
    double worst = 0;
    for (size_t i = 0; i < a.size(); ++i) worst = std::max(worst, difference(a[i], b[i]));
    return worst;
}

constexpr double kTolerance = 2e-5;  // of a creature some units long: float against double

class Cli : public ToolTestWithCreature {
protected:
    static Json pose(const Words& arguments) { return json_of("pose creature.glb" + arguments); }
    static double clip_duration_s(size_t clip) { return json_of("info creature.glb")["clips"][clip]["duration_s"]; }
};

// The largest difference between all matrices and positions of two poses.
double pose_difference(const Json& a, const Json& b) {
    double worst = a["skins"].size() == b["skins"].size() && a["primitives"].size() == b["primitives"].size() ? 0
                                                                                                              : 1e30;
    for (size_t i = 0; i < a["skins"].size(); ++i)
        for (const char* key : {"jointWorld", "skinMatrix"})
            worst = std::max(worst, difference(a["skins"][i][key], b["skins"][i][key]));
    for (size_t i = 0; i < a["primitives"].size(); ++i)
        worst = std::max(worst, difference(a["primitives"][i]["positions"], b["primitives"][i]["positions"]));
    return worst;
}

TEST_F(Cli, HelpHasExamples) {
    const std::string all = succeed("--help").out, benches = succeed("bench --help").out;
    for (const char* command : {"info", "compile", "controller check", "controller graph", "pose", "render", "generate",
                                "devices", "view", "bench", "tune", "bench baselines", "bench control", "bench cpu",
                                "bench draw", "bench frame", "bench scan", "bench view"}) {
        const std::string name(command), first = name.substr(0, name.find(' '));
        EXPECT_TRUE(contains(all, "\n  " + first + " ")) << command;
        EXPECT_TRUE(first != "bench" || first == name || contains(benches, "\n  " + name.substr(6) + " ")) << command;
        const Outcome run = succeed(Words(command) + "--help");
        EXPECT_TRUE(contains(run.out, "Examples:\n  throng " + name)) << run;
    }
    for (const char* command : {"bench diagrams", "bench report"}) {  // one example is enough for these
        const Outcome run = succeed(Words(command) + "--help");
        EXPECT_TRUE(contains(run.out, std::string("Example:\n  throng ") + command)) << run;
    }
    EXPECT_EQ(succeed("--version").out, std::string(version()) + "\n");
    EXPECT_EQ(version(), std::to_string(THRONG_VERSION_MAJOR) + "." + std::to_string(THRONG_VERSION_MINOR) + "." +
                             std::to_string(THRONG_VERSION_PATCH));
}

TEST_F(Cli, InfoCountsExactly) {
    const Json info = json_of("info creature.glb --lods");
    EXPECT_EQ(info["file"], "creature.glb");
    EXPECT_EQ(info["joints"], kCreatureJoints);
    EXPECT_EQ(info["levels"], kCreatureLevels);
    EXPECT_EQ(info["palette_entries"], kCreatureJoints);
    ASSERT_EQ(info["skins"].size(), 1u);
    EXPECT_EQ(info["skins"][0]["joints"], kCreatureJoints);
    ASSERT_EQ(info["clips"].size(), 5u);
    double squared = 0;
    for (size_t axis = 0; axis < 3; ++axis)
        squared += std::pow(info["bounds"][1][axis].get<double>() - info["bounds"][0][axis].get<double>(), 2);
    EXPECT_NEAR(std::sqrt(squared), info["size"], 1e-5 * info["size"].get<double>());
    const char* names[] = {"idle", "walk", "fly", "glide", "roar"};
    uint64_t clip_bytes = 0, raw_bytes = 0;
    for (size_t i = 0; i < 5; ++i) {
        const Json& clip = info["clips"][i];
        EXPECT_EQ(clip["name"], names[i]);
        EXPECT_GT(clip["duration_s"], 0);
        EXPECT_EQ(clip["channels"], kCreatureJoints + 1);
        EXPECT_GT(clip["error_percent"], 0);
        EXPECT_LE(clip["error_percent"], 0.01);
        EXPECT_GT(clip["raw_bytes"], clip["bytes"]);
        clip_bytes += clip["bytes"].get<uint64_t>();
        raw_bytes += clip["raw_bytes"].get<uint64_t>();
    }
    ASSERT_GE(info["lods"].size(), 2u);
    Json finer{{"faces", info["faces"]}, {"joints", kCreatureJoints}, {"error_percent", 0}};
    for (const Json& lod : info["lods"]) {
        EXPECT_LT(lod["faces"], finer["faces"]);
        EXPECT_LE(lod["joints"], finer["joints"]);
        EXPECT_GE(lod["error_percent"], finer["error_percent"]);
        EXPECT_GT(lod["error_percent"], 0);
        finer = lod;
    }
    EXPECT_EQ(info["packed"], true);
    EXPECT_EQ(info["clip_bytes"], clip_bytes);
    EXPECT_EQ(info["clip_raw_bytes"], raw_bytes);
    EXPECT_GE(info["bytes_per_character"], clip_bytes);
    EXPECT_GE(info["bytes_per_instance"], kCreatureJoints * 48);
    EXPECT_LE(info["bytes_per_instance"], kCreatureJoints * 48 + 256);
    EXPECT_TRUE(info["warnings"].empty());

    const Json exact = json_of("info creature.glb --error exact"), coarse = json_of("info creature.glb --error 1");
    EXPECT_EQ(exact["packed"], false);
    EXPECT_EQ(exact["error_percent"], 0);
    for (const Json& clip : exact["clips"])
        EXPECT_GE(clip["bytes"].get<uint64_t>(),
                  clip["rows"].get<uint64_t>() * clip["animated_tracks"].get<uint64_t>() * 16);
    EXPECT_GT(exact["clip_bytes"], info["clip_bytes"]);
    EXPECT_GT(info["clip_bytes"], coarse["clip_bytes"]);
    EXPECT_GT(coarse["error_percent"], 0.01);

    const Outcome text = succeed("info creature.glb");
    EXPECT_FALSE(contains(text.out, "lod ")) << text;
    for (const std::string& part :
         {std::string("40 joints, 12 levels"), std::string("idle"), std::string("walk"), std::string("fly"),
          std::to_string(info["bytes_per_instance"].get<int>()) + " bytes an instance",
          std::to_string(info["faces"].get<int>()) + " faces", std::string(" m, of which ")})
        EXPECT_TRUE(contains(text.out, part)) << part << "\n" << text;
}

// Levels of detail take longest to make, so they are made only on request.
TEST_F(Cli, InfoMakesLevelsOfDetailOnRequest) {
    Json with = json_of("info creature.glb --lods"), without = json_of("info creature.glb");
    EXPECT_FALSE(with["lods"].empty());
    EXPECT_TRUE(without["lods"].is_array() && without["lods"].empty());
    with.erase("lods"), without.erase("lods");
    EXPECT_EQ(with, without) << "all else is the same";
    const Outcome text = run_tool("info creature.glb --lods");
    EXPECT_TRUE(contains(text.out, "lod 1")) << text;
    succeed("compile creature.glb -o detailed.throng");
    EXPECT_FALSE(json_of("info detailed.throng")["lods"].empty()) << "those of a compiled file are there";
    fs::remove("detailed.throng");
}

TEST_F(Cli, InfoAndReferencePoseNeedNoGpu) {
    const RunSettings no_driver{
        .environment = {{"VK_ICD_FILENAMES", "/nonexistent.json"}, {"VK_DRIVER_FILES", "/nonexistent.json"}}};
    succeed("info creature.glb", no_driver);
    succeed("pose creature.glb --reference", no_driver);
    EXPECT_EQ(Json::parse(succeed("info creature.glb --json", no_driver).out)["update"]["path"], "native, fused");
    // The native device also needs no driver.
    EXPECT_NE(run_tool("pose creature.glb", no_driver).out.find("creature.glb on native ("), std::string::npos);
    EXPECT_NE(run_tool("devices", no_driver).out.find("0  native ("), std::string::npos);
    const Outcome cpu = run_tool("pose creature.glb --device cpu", no_driver),
                  picture = run_tool("render creature.glb --out crowd.png", no_driver);
    EXPECT_TRUE(cpu.refused("driver")) << cpu;
    EXPECT_TRUE(picture.succeeded()) << picture;
    EXPECT_TRUE(contains(picture.out, "renderer native")) << picture;
    const Outcome vulkan = run_tool("render creature.glb --renderer vulkan --out crowd.png", no_driver);
    EXPECT_TRUE(vulkan.refused("choose a Vulkan device")) << vulkan;
}

TEST_F(Cli, PoseHasItsDocumentedShape) {
    const Json all = pose("--clip walk --time 0.3 --vertices all"), some = pose("--clip walk --time 0.3 --vertices 5");
    EXPECT_EQ(keys(all), set_of("file device rig skins primitives"));
    const Json rig = json_of("info creature.glb --joints")["rig"];
    ASSERT_EQ(all["rig"]["joints"].size(), size_t{kCreatureJoints});
    ASSERT_EQ(rig.size(), size_t{kCreatureJoints});
    for (size_t joint = 0; joint < kCreatureJoints; ++joint) {
        EXPECT_EQ(all["rig"]["joints"][joint], rig[joint]["name"]);
        EXPECT_TRUE(joint == 0 ? rig[joint]["parent"].is_null() : rig[joint]["parent"] < joint);
    }
    EXPECT_EQ(all["rig"]["jointWorld"].size(), size_t{kCreatureJoints});
    ASSERT_EQ(all["skins"].size(), 1u);
    const Json& skin = all["skins"][0];
    EXPECT_EQ(keys(skin), set_of("skin joints jointWorld skinMatrix"));
    EXPECT_EQ(skin["joints"].size(), size_t{kCreatureJoints});
    for (const char* key : {"jointWorld", "skinMatrix"}) {
        ASSERT_EQ(skin[key].size(), size_t{kCreatureJoints});
        for (const Json& matrix : skin[key]) {
            ASSERT_EQ(matrix.size(), 16u);
            EXPECT_EQ((Json{matrix[3], matrix[7], matrix[11], matrix[15]}), (Json{0, 0, 0, 1}));
        }
    }
    ASSERT_EQ(all["primitives"].size(), 1u);
    const Json &every = all["primitives"][0], &few = some["primitives"][0];
    EXPECT_EQ(keys(every), set_of("node mesh primitive skin vertices positions"));
    EXPECT_EQ(every["vertices"].size(), json_of("info creature.glb")["vertices"].get<size_t>());
    ASSERT_EQ(few["vertices"].size(), 5u);
    for (size_t i = 0; i < 5; ++i) EXPECT_EQ(few["positions"][i], every["positions"][few["vertices"][i].get<size_t>()]);
    EXPECT_TRUE(pose({})["primitives"][0]["positions"].empty());
}

TEST_F(Cli, PoseOnTheGpuAgreesWithTheReference) {
    for (const std::string arguments :
         {"", "--clip idle --time 0.4", "--clip 2 --time 0.777", "--clip walk --time -0.1",
          "--clip walk --time 1000 --loop", "--clip walk --time 0.3 --blend fly --blend-time 0.5 --weight 0.25",
          "--clip 1 --time 12.3 --blend 0 --blend-time 45.6 --weight 0.5 --loop"}) {
        const Json gpu = pose(arguments + " --vertices all"),
                   reference = pose(arguments + " --vertices all --reference");
        EXPECT_LE(pose_difference(gpu, reference), kTolerance) << arguments;
        EXPECT_EQ(reference["device"], "reference");
    }
}

TEST_F(Cli, PoseUsesTheGivenClipsTimesAndWeights) {
    const auto reference = [&](const Words& arguments) { return pose(arguments + "--vertices all --reference"); };
    const Json walk = reference("--clip walk --time 0.3"), fly = reference("--clip fly --time 0.5"),
               rest = reference({});
    EXPECT_EQ(walk, reference("--clip 1 --time 0.3"));
    EXPECT_GT(pose_difference(walk, fly), 0.01);
    EXPECT_GT(pose_difference(walk, rest), 0.01);
    for (const Json& matrix : rest["skins"][0]["skinMatrix"])
        EXPECT_LE(difference(matrix, Json{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}), kTolerance);

    const auto blend = [&](const char* weight) {
        return reference("--clip walk --time 0.3 --blend fly --blend-time 0.5 --weight" + Words{weight});
    };
    EXPECT_LE(pose_difference(blend("1"), walk), 1e-12);
    EXPECT_LE(pose_difference(blend("0"), fly), 1e-12);
    EXPECT_GT(pose_difference(blend("0.5"), walk), 0.01);
    EXPECT_GT(pose_difference(blend("0.5"), fly), 0.01);

    const auto walk_at = [&](double time_s) { return "--clip walk --time " + std::to_string(time_s); };
    const double duration_s = clip_duration_s(1);
    EXPECT_LE(pose_difference(reference(walk_at(duration_s + 0.3) + " --loop"), walk), kTolerance);
    EXPECT_LE(pose_difference(reference(walk_at(duration_s + 0.3)), reference(walk_at(duration_s))), kTolerance);
    EXPECT_GT(pose_difference(reference(walk_at(duration_s + 0.3)), walk), 0.01);
}

TEST_F(Cli, PosePrintsOneLinePerJoint) {
    const Outcome run = succeed("pose creature.glb --reference");
    EXPECT_EQ(std::count(run.out.begin(), run.out.end(), '\n'), kCreatureJoints + 1);
}

TEST_F(Cli, RenderWritesAPictureOfTheAskedSize) {
    const auto render = [&](const std::string& out, const std::string& seed, const std::string& more = "") {
        return run_tool("render creature.glb creature.glb --count 9 --size 320x200 --time 0.5 --seed " + seed +
                        " --out " + out + " " + more);
    };
    const Outcome text = render("a.png", "1"), json = render("b.png", "1", "--json"), other = render("c.png", "2");
    EXPECT_TRUE(text.succeeded()) << text;
    for (const char* stage : {"control", "fused", "skin+draw"}) {
        EXPECT_TRUE(contains(text.out, std::string(" ") + stage + " ")) << text;
        EXPECT_GT(Json::parse(json.out)["stages_ms"][stage], 0);
    }
    EXPECT_FALSE(contains(text.out, " bind ")) << "the crowd has no such stage: " << text;
    EXPECT_EQ(Json::parse(json.out)["stages_ms"]["bind"], 0);
    EXPECT_EQ(Json::parse(json.out)["count"], 9);
    EXPECT_EQ(Json::parse(json.out)["out"], "b.png");
    EXPECT_EQ(read_file("a.png"), read_file("b.png"));
    EXPECT_NE(read_file("a.png"), read_file("c.png"));

    const Png picture = read_png("a.png");
    EXPECT_EQ(picture.width, 320);
    EXPECT_EQ(picture.height, 200);
    std::set<std::array<uint8_t, 4>> colors;
    for (size_t i = 0; i < picture.rgba.size(); i += 4)
        colors.insert({picture.rgba[i], picture.rgba[i + 1], picture.rgba[i + 2], picture.rgba[i + 3]});
    EXPECT_GT(colors.size(), 100u);

    const Json coarse = Json::parse(render("coarse.png", "1", "--json --lod-pixels 1000").out),
               fine = Json::parse(render("fine.png", "1", "--json --lod-pixels 0.01").out);
    EXPECT_GT(coarse["drawn"].size(), 1u);
    EXPECT_LT(coarse["drawn"][0], 9) << "who stands far enough from the eye is drawn coarser";
    EXPECT_EQ(fine["drawn"], Json::array({9}));

    EXPECT_EQ(json_of("render creature.glb --size 64x64 --out one.png")["count"], 1);
}

TEST_F(Cli, BothRenderersDrawThePicture) {
    const auto picture = [&](const std::string& device, const std::string& renderer) {
        const Outcome run = succeed("render creature.glb --count 30 --size 320x200 --json --out of.png --device " +
                                    device + " --renderer " + renderer);
        EXPECT_EQ(Json::parse(run.out)["renderer"], renderer);
        EXPECT_GT(Json::parse(run.out)["stages_ms"]["skin+draw"], 0);
        const Png png = read_png("of.png");
        return Picture{320, 200, png.rgba};
    };
    const Picture native = picture("native", "native");
    EXPECT_EQ(picture("cpu", "native").rgba, native.rgba);
    EXPECT_GT(bench::psnr(picture("cpu", "vulkan"), native), 45);
    const Outcome chosen = succeed("render creature.glb --size 64x64 --json --out of.png --device cpu");
    EXPECT_EQ(Json::parse(chosen.out)["renderer"], "native");
    EXPECT_TRUE(run_tool("render creature.glb --out of.png --device native --renderer vulkan")
                    .refused("choose a Vulkan device"));
}

TEST_F(Cli, GenerateIsExactAndDeterministic) {
    const auto generate = [&](const char* seed, const char* out) {
        const Outcome run = succeed(
            {"generate", "--joints", "123", "--levels", "45", "--faces", "1000", "--seed", seed, "--out", file(out)});
        EXPECT_TRUE(contains(run.out, "123 joints, 45 levels")) << run;
        return read_file(file(out));
    };
    const std::string first = generate("7", "first.glb");
    EXPECT_EQ(first, generate("7", "again.glb"));
    EXPECT_NE(first, generate("8", "other.glb"));
    const Json info = json_of("info first.glb");
    EXPECT_EQ(info["joints"], 123);
    EXPECT_EQ(info["levels"], 45);
    EXPECT_LE(info["faces"], 1000);
    EXPECT_GE(info["faces"], 950);
}

// If `throng` is copied without the other programs, the error names the missing one.
TEST_F(Cli, AMissingOtherProgramIsNamed) {
    const std::filesystem::path tool = THRONG_TOOL;
    const std::string alone = file("throng");
    std::filesystem::copy_file(tool, alone);
    const std::string library = tool.parent_path().parent_path().string();
    for (const auto& [command, program] :
         {std::pair{"bench", "throng-bench"}, {"tune", "throng-bench"}, {"view", "throng-view"}}) {
        const Outcome run = run_tool({command},
                                     {.environment = {{"LD_LIBRARY_PATH", library}}, .program = alone.c_str()});
        EXPECT_TRUE(run.refused(file(program))) << run;
    }
    std::filesystem::remove(alone);
}

TEST_F(Cli, DevicesAreListed) {
    const Json devices = json_of("devices");
    ASSERT_FALSE(devices.empty());
    for (size_t i = 0; i < devices.size(); ++i) {
        EXPECT_EQ(devices[i]["index"], i);
        EXPECT_EQ(keys(devices[i]), set_of("index name type driver vulkan subgroup_size shared_memory_bytes "
                                           "storage_buffer_range_bytes usable compiles_only"));
    }
    const Outcome text = run_tool("devices");
    EXPECT_TRUE(contains(text.out, devices[0]["name"].get<std::string>())) << text;
    succeed({"pose", "creature.glb", "--device", devices[0]["name"]});
}

}  // namespace
}  // namespace throng
