// `throng bench` and `throng tune`: their records have the fields that users read, and wrong results are not timed.
#include "tests/cli/cli_cases.h"
#include "tests/text.h"

#include <throng/crowd.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace throng {
namespace {

using namespace test;
namespace fs = std::filesystem;

class CliBench : public ToolTestWithCreature {};

TEST_F(CliBench, BenchHasARecordForEachScanMethod) {
    const Outcome text = succeed("bench creature.glb --count 50 --samples 2");
    const Outcome run = succeed("bench creature.glb --count 50 --samples 2 --json", kOfCommit);
    std::set<std::string> scans;
    for (const Json& record : records_of(run.out)) {
        EXPECT_EQ(keys(record),
                  set_of("bench scan path characters joints files clips_blended samples host_samples stages total "
                         "ns_per_joint max_error memory_bytes device driver subgroup_size commit date"));
        EXPECT_EQ(record["path"], "staged");
        EXPECT_EQ(record["stages"]["fused"]["median_ms"], 0);
        EXPECT_GT(record["stages"]["sample"]["median_ms"], 0);
        EXPECT_EQ(record["characters"], 50);
        EXPECT_EQ(record["joints"], 50 * kCreatureJoints);
        EXPECT_EQ(record["samples"], 2);
        EXPECT_EQ(record["commit"], "abc1234");
        EXPECT_LT(record["max_error"], 1e-4);
        EXPECT_GE(record["memory_bytes"], 50 * kCreatureJoints * 48);
        EXPECT_EQ(keys(record["stages"]), std::set<std::string>(stage_names().begin(), stage_names().end()));
        for (const Json& spread : {record["stages"]["scan"], record["total"]}) {
            EXPECT_EQ(keys(spread), set_of("median_ms p5_ms p95_ms"));
            EXPECT_LE(spread["p5_ms"], spread["median_ms"]);
            EXPECT_LE(spread["median_ms"], spread["p95_ms"]);
        }
        ASSERT_EQ(record["files"].size(), 1u);
        EXPECT_EQ(keys(record["files"][0]), set_of("name joints levels mean_depth leaves palette_entries keys"));
        EXPECT_TRUE(record["files"][0]["keys"].get<std::string>().ends_with(" %"));
        EXPECT_TRUE(scans.insert(record["scan"]).second) << "twice: " << record["scan"];
        EXPECT_TRUE(contains(text.out, record["scan"].get<std::string>()));
    }
    const Outcome fused = succeed(
        "bench creature.glb --count 50 --samples 1 --scan auto --path fused --error exact --json");
    EXPECT_EQ(Json::parse(fused.out)["path"], "fused");
    EXPECT_EQ(Json::parse(fused.out)["files"][0]["keys"], "exact");
    EXPECT_TRUE(contains(text.out, " staged ")) << text;
    EXPECT_EQ(
        json_of("bench creature.glb --count 5 --samples 1 --scan auto --path auto --device native --json")["path"],
        "native, fused");
    // Every method that --help names.
    const std::string help = run_tool("bench --help").out;
    EXPECT_GE(scans.size(), 2u);
    for (const std::string& scan : scans) EXPECT_TRUE(contains(help, scan)) << scan;
}

TEST_F(CliBench, BenchReportsWhyAMethodDoesNotApply) {
    const Outcome run = succeed("bench creature.glb --count 5 --samples 1 --path fused --json", kOfCommit);
    size_t unsupported = 0;
    for (const Json& record : records_of(run.out)) {
        EXPECT_EQ(record["commit"], "abc1234");
        if (!record.contains("unsupported_reason")) continue;
        EXPECT_EQ(keys(record), set_of("bench scan unsupported_reason device driver subgroup_size commit date"));
        ++unsupported;
    }
    EXPECT_GT(unsupported, 0u);
    EXPECT_LT(unsupported, records_of(run.out).size());
}

TEST_F(CliBench, OptionsWithoutEffectAreRefused) {
    expect_refused({{"bench --count 7 summary none.jsonl --out s.md", "--count has no effect before 'summary'"},
                    {"bench creature.glb summary none.jsonl --out s.md", "creature.glb has no effect"},
                    {"bench creature.glb --joints 9 --count 1 --samples 1 --scan serial", "--joints"},
                    {"bench creature.glb --levels 9 --count 1 --samples 1 --scan serial", "--levels"},
                    {"bench cpu creature.glb --joints 9 --characters 1 --samples 1", "--joints"},
                    {"bench cpu creature.glb --levels 9 --characters 1 --samples 1", "--levels"},
                    {"bench baselines creature.glb --joints 9 --count 1 --samples 1", "--joints"},
                    {"bench baselines creature.glb --levels 9 --count 1 --samples 1", "--levels"}});
    EXPECT_EQ(run_tool("bench cpu --isa mmx").exit_code, 2);
    EXPECT_EQ(run_tool({"tune", "--predicted", "RTX 3080", "--device", "cpu"}).exit_code, 2);
}

// Costs are stored where the next choice finds them, even if the existing file is damaged.
TEST_F(CliBench, TuneStoresTheCostsThatInfoUses) {
    const fs::path cache = file("cache");
    const std::map<std::string, std::string> environment{{"XDG_CACHE_HOME", cache.string()}};
    const auto costs = [&] {  // the cache also has a folder of characters
        std::vector<fs::path> files;
        for (const fs::directory_entry& entry : fs::directory_iterator(cache / "throng"))
            if (entry.is_regular_file()) files.push_back(entry.path());
        return files;
    };
    const auto scan_line = [&] {
        const Outcome info = succeed("info creature.glb --count 500", {.environment = environment});
        return info.out.substr(info.out.find("  scan "));
    };
    EXPECT_TRUE(contains(scan_line(), "500 x " + std::to_string(kCreatureJoints) + " joints"));
    EXPECT_TRUE(contains(scan_line(), "costs: built in")) << scan_line();

    const Outcome dry = succeed("tune --quick --dry-run --json", {.environment = environment});
    EXPECT_GT(Json::parse(dry.out)["row_ns"].get<double>(), 0);
    EXPECT_TRUE(costs().empty());

    const Outcome tune = succeed("tune --quick", {.environment = environment});
    EXPECT_TRUE(contains(scan_line(), "costs: measured by throng tune")) << scan_line();

    ASSERT_EQ(costs().size(), 1u) << "one file, and nothing temporary";
    const fs::path file = costs()[0];
    std::ofstream(file) << "{}";
    EXPECT_TRUE(contains(scan_line(), file.string())) << scan_line();
    fs::remove(file);
    fs::create_directory(file);
    const Outcome taken = run_tool("tune --quick", {.environment = environment});
    EXPECT_TRUE(taken.refused("exists and is not a regular file")) << taken;
    EXPECT_EQ(taken.out, "") << "refused before anything is measured";

    const fs::path blocked = this->file("blocked");
    fs::create_directory(blocked);
    std::ofstream(blocked / "throng") << "no folder";
    EXPECT_TRUE(run_tool("tune --quick", {.environment = {{"XDG_CACHE_HOME", blocked.string()}}})
                    .refused((blocked / "throng").string()));
}

TEST_F(CliBench, BenchScanHasARecordForEachMethodAndCase) {
    const Outcome run = succeed(
        "bench scan --methods serial,compressed --characters 20 --joints 30 --levels 5,9 --samples 2 --json scan.jsonl",
        kOfCommit);
    std::set<std::string> cases;
    for (const Json& record : records_of(read_file("scan.jsonl"))) {
        const bool on_chip = record["experiment"] == "on_chip";
        std::set<std::string> wanted = set_of(
            "bench experiment method shape seed characters joints levels "
            "mean_depth leaves device driver subgroup_size commit date");
        if (!record.contains("unsupported_reason")) {
            wanted.merge(
                set_of("threads workgroup_size multiplications longest_thread barriers shared_bytes max_error "
                       "samples"));
            if (on_chip)
                wanted.merge(set_of("on_chip_ns_per_joint on_chip_p5 on_chip_p95 barrier_share"));
            else
                wanted.merge(set_of("bytes median_ms p5_ms p95_ms copy_ms times_copy ns_per_joint"));
            EXPECT_LE(record["max_error"], 1e-5);
            EXPECT_EQ(record["samples"], 2);
        } else {
            wanted.insert("unsupported_reason");
        }
        if (record["method"] == "auto") wanted.insert("chosen");
        EXPECT_EQ(keys(record), wanted);
        EXPECT_EQ(record["bench"], "scan");
        EXPECT_EQ(record["characters"], 20);
        EXPECT_EQ(record["joints"], 30);
        EXPECT_EQ(record["commit"], "abc1234");
        if (record.contains("median_ms")) {
            const bool of_similarities = contains(record.value("chosen", ""), "_quaternion");
            EXPECT_EQ(record["bytes"], 20 * 30 * (of_similarities ? 80 : 96));
            EXPECT_LE(record["p5_ms"], record["median_ms"]);
            EXPECT_LE(record["median_ms"], record["p95_ms"]);
            EXPECT_NEAR(record["times_copy"].get<double>(),
                        record["median_ms"].get<double>() / record["copy_ms"].get<double>(), 1e-9);
        }
        EXPECT_TRUE(cases
                        .insert(record["experiment"].get<std::string>() + record["levels"].dump() +
                                record["method"].get<std::string>())
                        .second)
            << "twice: " << record;
        EXPECT_TRUE(contains(run.out, record["method"].get<std::string>()));
    }
    EXPECT_EQ(cases, set_of("levels5auto levels5serial levels5compressed levels9auto levels9serial "
                            "levels9compressed on_chip5serial on_chip5compressed on_chip9serial "
                            "on_chip9compressed"));
    const std::string help = run_tool("bench scan --help").out;
    EXPECT_TRUE(contains(help, "Examples:\n  throng bench scan")) << help;
}

TEST_F(CliBench, BenchCpuChecksAndTimesEachInstructionSet) {
    const Outcome run = succeed("bench cpu --characters 40 --joints 40 --levels 8 --threads 2,1 --samples 2 --json",
                                kOfCommit);
    size_t timed = 0;
    for (const Json& record : records_of(run.out)) {
        EXPECT_EQ(record["bench"], "cpu");
        EXPECT_EQ(record["commit"], "abc1234");
        EXPECT_FALSE(record.contains("wrong"));
        EXPECT_GT(record["wall_ms"]["p5"], 0);
        EXPECT_EQ(record.contains("times_one_thread"), record["threads"] == 2);
        if (record["variant"] == "fill") continue;
        EXPECT_LT(record["max_error"], 1e-4);
        EXPECT_GT(record["times_fill_floor"], 0);
        ++timed;
    }
    EXPECT_GE(timed, 8u);
    const std::string help = run_tool("bench cpu --help").out;
    EXPECT_TRUE(contains(help, "Examples:\n  throng bench cpu")) << help;
}

TEST_F(CliBench, BenchDrawComparesPicturesAndTimesThem) {
    const std::string command = "bench draw creature.glb --count 9 --size 160x90 --samples 1 --threads 2,1";
    const Outcome text = succeed(command);
    const Outcome run = succeed(command + " --against-vulkan --json", kOfCommit);
    size_t native = 0, vulkan = 0;
    for (const Json& record : records_of(run.out)) {
        const bool is_native = record["renderer"] == "native";
        std::set<std::string> wanted = set_of(
            "bench configuration renderer variant size samples_per_pixel characters drawn vertices triangles samples "
            "ms "
            "mtriangles_per_s msamples_per_s device driver subgroup_size commit date");
        wanted.merge(set_of(is_native ? "threads parts times_faster" : "host_samples"));
        if (record.contains("alike_db")) wanted.insert("alike_db");
        EXPECT_EQ(keys(record), wanted) << record;
        EXPECT_EQ(record["commit"], "abc1234");
        EXPECT_EQ(record["drawn"], 9);
        if (!is_native) {
            EXPECT_GT(record["alike_db"], 45);
        }
        ++(is_native ? native : vulkan);
    }
    EXPECT_GE(native, 2u);
    EXPECT_EQ(vulkan, 1u);
    EXPECT_TRUE(contains(text.out, "9 x creature.glb, 160x90")) << text;
    const Outcome mixed = succeed(
        "bench draw creature.glb creature.glb --count 2 --size 32x18 --samples 1 --threads 1");
    EXPECT_TRUE(contains(mixed.out, "2 x creature.glb, creature.glb, 32x18")) << mixed;
    expect_refused({{"bench draw --count 0", "--count"},
                    {"bench draw nobody.glb", "nobody.glb"},
                    {"bench draw creature.glb --size 20000x9", "16384"}});
}

TEST_F(CliBench, BenchFrameHasARecordForEachVariantOfEachConfiguration) {
    const Outcome run = succeed("bench frame --quick --count 20 --samples 2 --json", kOfCommit);
    std::map<std::string, std::set<std::string>> variants;  // of each configuration
    for (const Json& record : records_of(run.out)) {
        std::set<std::string> wanted = set_of(
            "bench configuration variant path characters joints levels "
            "mean_depth palette_entries bytes device driver subgroup_size "
            "commit date");
        const bool is_copy = record["path"] == "copy", is_floor = is_copy || record["path"] == "fill";
        if (is_floor)
            wanted.insert("by");
        else
            wanted.merge(set_of("clips keys"));
        if (!is_copy) wanted.insert("skin_format");
        if (record.contains("unsupported_reason"))
            wanted.insert("unsupported_reason");
        else
            wanted.merge(set_of("samples host_samples ms ns_per_joint gb_per_s"));
        if (!is_floor && !record.contains("unsupported_reason"))
            wanted.merge(set_of("scan max_error stages times_fill_floor"));
        EXPECT_EQ(keys(record), wanted) << record;
        EXPECT_EQ(record["bench"], "frame");
        EXPECT_EQ(record["characters"], 20);
        EXPECT_EQ(record["commit"], "abc1234");
        EXPECT_TRUE(variants[record["configuration"]].insert(record["variant"]).second) << "twice: " << record;
    }
    ASSERT_EQ(variants.size(), 5u) << "two of the six differ in the number of characters alone";
    for (const auto& [configuration, names] : variants)
        for (const char* name : {"staged", "fused", "fused, one clip", "fused, 24 bytes", "fused, 32 bytes",
                                 "fill, 48 bytes", "vkCmdFillBuffer", "copy as staged"})
            EXPECT_TRUE(names.contains(name)) << configuration << ": " << name;
    EXPECT_TRUE(variants["20 x 300, 60 levels"].contains("fused, exact keys"));
    const std::string help = run_tool("bench frame --help").out;
    EXPECT_TRUE(contains(help, "Examples:\n  throng bench frame")) << help;
}

TEST_F(CliBench, BenchFrameMeasuresAFileAndWritesAReport) {
    const Outcome run = succeed("bench frame creature.glb --count 30 --samples 1 --error exact --report frame.html");
    EXPECT_TRUE(contains(run.out, "30 x creature.glb, keys exact: 30 characters x 40 joints")) << run;
    EXPECT_TRUE(contains(run.out, "\ncopy as staged")) << run;
    EXPECT_TRUE(contains(read_file("frame.html"), "Whole updates"));
}

TEST_F(CliBench, BenchViewHasARecordForEachVariant) {
    const std::string command = "bench view creature.glb --count 60 --samples 1 --size 320x180";
    const Outcome text = succeed(command);
    const Outcome run = succeed(command + " --json", kOfCommit);
    std::set<std::string> variants;
    for (const Json& record : records_of(run.out)) {
        std::set<std::string> wanted = set_of(
            "bench configuration variant path characters joints levels drawn "
            "memory_bytes max_error samples ms stages times_faster device "
            "driver subgroup_size commit date");
        if (record["variant"] != "everything") wanted.insert("lod_pixels");
        if (record.contains("max_pixels")) wanted.insert("max_pixels");
        if (record.contains("full_rate_pixels")) wanted.insert("full_rate_pixels");
        EXPECT_EQ(keys(record), wanted);
        EXPECT_EQ(record["commit"], "abc1234");
        EXPECT_TRUE(variants.insert(record["variant"]).second);
        EXPECT_TRUE(contains(text.out, record["variant"].get<std::string>())) << text;
    }
    EXPECT_EQ(variants.size(), 4u);
    const Outcome nobody = succeed("bench view creature.glb --count 20 --samples 1 --eye 0,500,0 --target 0,1000,1");
    EXPECT_TRUE(contains(nobody.out, "not measured: the camera sees none")) << nobody;
    EXPECT_TRUE(run_tool("bench view --count 0").refused("--count"));
}

TEST_F(CliBench, PopulationHasARecordForEachPartAndTurnover) {
    const std::string command = "bench population creature.glb --count 200 --samples 2";
    std::multiset<std::string> instances, frames;
    for (const Json& record : records_of(succeed(command + " --json", kOfCommit).out)) {
        EXPECT_EQ(record["bench"], "population");
        EXPECT_EQ(record["capacity"], 200);
        const std::string common =
            "bench configuration path capacity joints levels characters samples max_error "
            "device driver subgroup_size commit date ";
        EXPECT_LT(record["max_error"], 1e-4);
        if (record.contains("frames_with")) {
            frames.insert(record["frames_with"]);
            EXPECT_EQ(keys(record), set_of(common + "frames_with changed call_ms update_ms"));
            EXPECT_EQ(record["changed"], 50);
            continue;
        }
        instances.insert(record["instances"]);
        EXPECT_EQ(keys(record), set_of(common + "instances memory_bytes ms stages"));
    }
    for (const char* kind : {"for good", "together", "last", "anywhere"}) EXPECT_EQ(instances.count(kind), 3u) << kind;
    EXPECT_EQ(frames, (std::multiset<std::string>{"births and deaths", "by shaders", "playbacks"}));
    const std::string text = succeed(command).out;
    EXPECT_TRUE(contains(text, "anywhere") && contains(text, "births and deaths")) << text;
    EXPECT_TRUE(run_tool("bench population --count 0").refused("--count"));
}

TEST_F(CliBench, MillionHasARecordForEachCameraAndEachNumberOfCharacters) {
    const std::string command = "bench million creature.glb --count 3000 --capacity 500 --samples 1 --size 320x180";
    std::set<std::string> views;
    uint32_t recordings = 0, shared = 0;
    for (const Json& record : records_of(succeed(command + " --json", kOfCommit).out)) {
        EXPECT_EQ(record["bench"], "million");
        if (record.contains("machine")) {
            EXPECT_GT(record["predicted_ms"], 0);
            EXPECT_EQ(record["commit"], "abc1234");
            continue;
        }
        if (record.contains("record_ms")) {
            EXPECT_GT(record["record_ms"]["median"], 0);
            ++recordings;
            continue;
        }
        views.insert(record["view"]);
        std::set<std::string> found = keys(record);
        EXPECT_EQ(found.erase("max_pixels_own"), record["own_poses"] > 0 ? 1u : 0u);
        EXPECT_EQ(found.erase("max_pixels"),
                  record["pool_is_full"] || record["drawn"] == record["own_poses"] ? 0u : 1u);
        EXPECT_EQ(found, set_of("bench configuration view characters joints levels path drawn own_poses distinct_poses "
                                "pool_is_full memory_bytes matrices_of_all_bytes samples ms stages "
                                "device driver subgroup_size commit date"));
        EXPECT_LE(record["own_poses"], 500);
        EXPECT_LE(record["own_poses"], record["distinct_poses"]);
        EXPECT_LE(record["distinct_poses"], record["drawn"]);
        EXPECT_LT(record["memory_bytes"], record["matrices_of_all_bytes"].get<double>() * 2);
        EXPECT_LE(record.value("max_pixels", 0.0), 2);
        shared += record["drawn"].get<uint32_t>() - record["own_poses"].get<uint32_t>();
    }
    EXPECT_EQ(views.size(), 5u);
    EXPECT_EQ(recordings, 2u) << "of 1,000 and of 3,000";
    EXPECT_GT(shared, 0u);
    const std::string text = succeed(command).out;
    EXPECT_TRUE(contains(text, "from above") && contains(text, "memory of the crowd")) << text;
    EXPECT_TRUE(run_tool("bench million --count 0").refused("--count"));
    EXPECT_TRUE(run_tool("bench million --blending 2").refused("--blending"));
}

TEST_F(CliBench, BenchBaselinesComparesAllThree) {
    const Outcome run = succeed("bench baselines creature.glb --count 50 --samples 2 --json baselines.jsonl",
                                kOfCommit);
    std::map<std::string, Json> records;
    for (const Json& record : records_of(read_file("baselines.jsonl"))) {
        EXPECT_EQ(record["bench"], "baseline");
        EXPECT_EQ(record["joints"], kCreatureJoints);
        EXPECT_EQ(record["characters"], 50);
        EXPECT_EQ(record["commit"], "abc1234");
        EXPECT_LT(record["max_error"], 1e-4);
        EXPECT_LE(record["p5_ms"], record["median_ms"]);
        EXPECT_LE(record["sample_error_mm_p95"], record["sample_error_mm_max"]);
        EXPECT_TRUE(contains(run.out, record["method"].get<std::string>())) << run;
        records[record["method"]] = record;
    }
    ASSERT_EQ(records.size(), 3u);
    for (const char* method : {"baked", "flattened"}) {
        EXPECT_GT(records[method]["bytes_per_clip"], records["throng"]["bytes_per_clip"]);
        EXPECT_GT(records[method]["blend_error_mm_max"], 100 * records["throng"]["blend_error_mm_max"].get<double>())
            << method;
    }
}

TEST_F(CliBench, BaselinesOfACharacterAreKeptIfALaterOneFails) {
    const Outcome run = run_tool("bench baselines creature.glb nobody.glb --count 5 --samples 1 --json early.jsonl");
    EXPECT_EQ(run.exit_code, 1);
    EXPECT_TRUE(contains(run.err, "nobody.glb")) << run;
    EXPECT_EQ(records_of(read_file("early.jsonl")).size(), 3u);
}

TEST_F(CliBench, BenchReportMakesAPageOfRecords) {
    std::ofstream("scan.jsonl")
        << R"({"bench": "scan", "experiment": "levels", "method": "serial", "levels": 15, "median_ms": 3, "copy_ms": )"
           R"(2, "times_copy": 1.5})"
           "\n";
    const Outcome run = succeed("bench report scan.jsonl --out report.html --plot levels.svg");
    EXPECT_GT(fs::file_size("report.html"), 10'000u);
    EXPECT_GT(fs::file_size("levels.svg"), 1'000u);
    std::ofstream("scan.jsonl", std::ios::app) << "{\"bench\": \n";
    const Outcome refused = run_tool("bench report scan.jsonl --out report.html");
    EXPECT_TRUE(refused.refused("scan.jsonl:2")) << refused;
}

}  // namespace
}  // namespace throng
