// The benchmark report: it contains every method, loads nothing from elsewhere, escapes records so that they cannot
// become markup or commands, and gives one clear error for missing data. Figures need gnuplot, which ./run installs.
#include "base/failure.h"
#include "bench/report/gnuplot.h"
#include "bench/report/html.h"
#include "bench/report/plot.h"
#include "bench/report/records.h"
#include "bench/scan_report.h"
#include "bench/summary.h"
#include "tests/files.h"
#include "tests/text.h"

#include <nlohmann/json.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <set>

namespace throng::bench {
namespace {

using test::count_of;
using test::TemporaryFolder;

const std::vector<std::string> kMethods{"gateau2012_walk", "compressed",    "serial",
                                        "fragments",       "not_known_yet", "auto"};

Json record(const std::string& experiment, const std::string& method, double levels, double ms) {
    return {{"bench", "scan"},       {"experiment", experiment},
            {"method", method},      {"threads", 32},
            {"shape", "random"},     {"seed", 1},
            {"joints", 300},         {"characters", 10'000},
            {"levels", levels},      {"mean_depth", 9.46},
            {"leaves", 47},          {"multiplications", 1692},
            {"median_ms", ms},       {"p5_ms", 0.9 * ms},
            {"p95_ms", 1.2 * ms},    {"copy_ms", 50},
            {"times_copy", ms / 50}, {"ns_per_joint", ms / 3},
            {"device", "A GPU"},     {"chosen", method == "auto" ? "serial" : ""}};
}

std::vector<Json> records_of(const std::string& experiment) {
    std::vector<Json> records;
    for (size_t m = 0; m < kMethods.size(); ++m)
        for (const double levels : {15.0, 60.0, 120.0})
            records.push_back(record(experiment, kMethods[m], levels, 60 + 31 * static_cast<double>(m) + levels));
    return records;
}

std::string failure_of(const auto& body) {
    try {
        body();
    } catch (const Failure& failure) {
        return failure.what();
    }
    return "none";
}

TEST(Report, HasEachMethodInFigureTableAndLegend) {
    const std::string html = scan_report(records_of("levels"));
    for (const std::string& method : kMethods) {
        EXPECT_GE(count_of(html, "data-series=\"" + method + "\"><title>" + method), 2u) << method;  // in both figures
        EXPECT_EQ(count_of(html, "data-method=\"" + method + "\""), 1u) << method;
        EXPECT_GE(count_of(html, "</span>" + method), 4u) << method;  // one table per level, and the legend
    }
    EXPECT_EQ(count_of(html, "<svg"), 2u);
    EXPECT_EQ(count_of(html, "<b>75.0</b>"), 1u) << "the fastest of 15 levels is bold";
}

TEST(Report, IsSelfContained) {
    std::vector<Json> records = records_of("levels");
    for (const char* experiment : {"joints", "characters", "on_chip", "grid"}) {
        const std::vector<Json> more = records_of(experiment);
        records.insert(records.end(), more.begin(), more.end());
    }
    for (const std::string& page : {scan_report(records), scan_levels_plot(records)})
        for (const char* external : {"src=", "href=\"", "href='h", "url(", "@import", "<link", "<!DOCTYPE svg"})
            EXPECT_EQ(count_of(page, external), 0u) << external;
}

TEST(Report, EscapesMarkupAndCommands) {
    const TemporaryFolder folder;
    const std::filesystem::path untouched = folder.write("untouched", "");
    const std::string remove = "rm " + untouched.string();
    for (const std::string& evil :
         {std::string("<script>x</script>&\"'"), "`" + remove + "`", "'\nsystem('" + remove + "')\n'",
          "\"\n!" + remove + "\n", std::string("\\\"@x$data1{/Bold ^_")}) {
        std::vector<Json> records = records_of("levels");
        const std::vector<Json> more = records_of("on_chip");
        records.insert(records.end(), more.begin(), more.end());
        for (Json& r : records) {
            r["device"] = evil;
            r["shape"] = evil;
            r["method"] = r["method"].get<std::string>() + evil;
            r["on_chip_ns_per_joint"] = 1;
            r["unsupported_reason"] = evil;
        }
        const std::string html = scan_report(records), plot = scan_levels_plot(records);
        EXPECT_EQ(count_of(html, "<script>"), 1u) << evil;  // the page's own
        EXPECT_EQ(count_of(plot, "<script>"), 0u) << evil;
        EXPECT_EQ(count_of(html, "<title>serial"), count_of(html, "data-series=\"serial")) << evil;
        EXPECT_TRUE(std::filesystem::exists(untouched)) << evil;
    }
    EXPECT_NE(scan_levels_plot(std::vector{record("levels", "serial", 15, 1)}).find("A GPU"), std::string::npos);
}

TEST(Report, SaysWhyAMethodIsNotTimed) {
    std::vector<Json> records{record("levels", "serial", 15, 60), record("levels", "fragments", 15, 60),
                              record("levels", "compressed", 15, 20)};
    records[1].erase("median_ms");
    records[1]["unsupported_reason"] = "1,000 joints are too many";
    records[2]["wrong"] = true;
    const std::string html = scan_report(records);
    EXPECT_NE(html.find("does not apply: 1,000 joints are too many"), std::string::npos);
    EXPECT_NE(html.find("wrong result, not timed"), std::string::npos);
    EXPECT_EQ(html.find("data-series=\"compressed\""), std::string::npos);
    EXPECT_NE(html.find("fastest serial (60.0 ms"), std::string::npos) << "and not the wrong one";
}

TEST(Report, TheLastRecordOfACaseCounts) {
    const std::string html = scan_report(
        std::vector{record("levels", "serial", 15, 61), record("levels", "serial", 15, 67)});
    EXPECT_EQ(html.find("61.0"), std::string::npos);
    EXPECT_NE(html.find("67.0"), std::string::npos);
}

TEST(Report, AcceptsIncompleteRecords) {
    std::vector<Json> records{Json::object(), {{"bench", "update"}},   {{"bench", "scan"}},
                              {{"bench", 3}}, {{"bench", "baseline"}}, {{"bench", "scan"}, {"method", "serial"}}};
    for (const char* experiment : {"levels", "joints", "characters", "on_chip", "grid"}) {
        records.push_back({{"bench", "scan"}, {"method", "serial"}, {"experiment", experiment}});
        records.push_back({{"bench", "scan"},
                           {"method", "auto"},
                           {"experiment", experiment},
                           {"levels", "many"},
                           {"median_ms", nullptr},
                           {"device", 7},
                           {"chosen", Json::array()}});
        records.push_back({{"bench", "scan"},
                           {"method", "serial"},
                           {"experiment", experiment},
                           {"levels", 0},
                           {"joints", 0},
                           {"characters", -1},
                           {"median_ms", 0},
                           {"ns_per_joint", 1},
                           {"times_copy", -1}});
        for (size_t i = 1; i <= records.size(); ++i)
            EXPECT_NE(scan_report(std::span(records).first(i)).find("</html>"), std::string::npos)
                << records[i - 1].dump();
    }
    EXPECT_NE(scan_report({}).find("no record"), std::string::npos);
    EXPECT_NE(failure_of([] { scan_levels_plot({}); }).find("time"), std::string::npos);
}

TEST(Report, SaysThatGnuplotIsMissing) {
    const std::string path = std::getenv("PATH") ? std::getenv("PATH") : "";
    setenv("PATH", "/nowhere", 1);
    const std::string failure = failure_of([] { scan_report(records_of("levels")); });
    setenv("PATH", path.c_str(), 1);
    EXPECT_EQ(failure, "gnuplot: not installed, and the plots need it (Debian: apt-get install gnuplot-nox)");
    EXPECT_EQ(failure_of([] { run_gnuplot("plot nothing\n"); }), "gnuplot: line 0: undefined variable: nothing");
}

TEST(Report, NeedsNoGnuplotWithoutFigures) {
    const std::string path = std::getenv("PATH") ? std::getenv("PATH") : "";
    setenv("PATH", "/nowhere", 1);
    const std::string page = scan_report(records_of("levels"), false);
    setenv("PATH", path.c_str(), 1);
    EXPECT_EQ(count_of(page, "<svg"), 0u);
    EXPECT_GT(count_of(page, "<table"), 0u);
}

TEST(Summary, HasALineForEachTimeBesideItsPrediction) {
    const Json fused{{"bench", "frame"},
                     {"configuration", "10000 x 300, 60 levels"},
                     {"variant", "fused"},
                     {"path", "fused"},
                     {"scan", "serial"},
                     {"subgroup_size", 32},
                     {"ms", {{"median", 0.3}, {"p5", 0.2}, {"p95", 0.4}}},
                     {"device", "NVIDIA H100 80GB HBM3"}};
    Json prediction = fused;
    prediction.update(
        {{"bench", "isa"}, {"kernel", "fused, two clips"}, {"machine", "H100 SXM"}, {"predicted_ms", 0.1}});
    Json of_other_subgroups = prediction, of_other_machine = prediction;
    of_other_subgroups.update({{"subgroup_size", 64}, {"predicted_ms", 7}});
    of_other_machine.update({{"machine", "RTX 3080"}, {"predicted_ms", 8}});
    const Json wrong{{"bench", "draw"}, {"configuration", "one dragon"}, {"variant", "vulkan"}, {"wrong", true}};
    const Json control{{"bench", "control"},
                       {"characters", 10'000},
                       {"joints", 300},
                       {"control_ms", {{"median", 8}}},
                       {"update_ms", {{"median", 70}}}};

    const std::vector<Json> records{fused, wrong, control};
    const std::string text = summary_text(records, std::vector<Json>{of_other_subgroups, of_other_machine, prediction});
    EXPECT_EQ(count_of(text, "| 10000 x 300, 60 levels | fused | 0.300 | 0.200 – 0.400 | 0.100 | 3.00 |"), 1u) << text;
    EXPECT_EQ(count_of(text, "| one dragon | vulkan | wrong, not timed |"), 1u) << text;
    EXPECT_EQ(count_of(text, "| the control stage | 8.00 |"), 1u) << text;
    EXPECT_EQ(count_of(text, "| the whole update | 70.0 |"), 1u) << text;

    EXPECT_EQ(count_of(summary_text(records, {}), "predicted"), 1u) << "says that nothing was, and has no column";
    EXPECT_EQ(count_of(summary_text(records, std::vector<Json>{of_other_machine}), "predicted |"), 0u);
    Json newer = prediction;
    newer["predicted_ms"] = 0.15;
    EXPECT_EQ(count_of(summary_text(records, std::vector<Json>{prediction, newer}), "| 0.150 | 2.00 |"), 1u);
    const std::string section = summary_section(records);
    EXPECT_EQ(count_of(section, "one dragon"), 1u);
    EXPECT_EQ(count_of(section, "60 levels"), 0u) << "updates have a section of their own";
}

// For the committed records. Runs with several cameras are left out, since records do not store the camera.
TEST(Summary, NoTwoRowsOfADeviceAreAlike) {
    size_t rows = 0;
    for (const auto& entry : std::filesystem::directory_iterator(THRONG_SOURCE_DIR "/bench/results")) {
        const std::string file = entry.path().filename();
        if (file.find("_view_lavapipe_") != std::string::npos) continue;
        std::set<std::vector<std::string>> seen;
        for (const MeasuredTime& time : measured_times(read_records(entry.path()), {})) {
            EXPECT_TRUE(seen.insert({time.device, time.bench, time.what, time.variant}).second)
                << file << ": " << time.bench << " | " << time.what << " | " << time.variant;
            ++rows;
        }
    }
    EXPECT_GT(rows, 1'000u);
}

TEST(Summary, RowsNameTheFileAndThePath) {
    const Json times{{"median", 1}};
    const std::vector<Json> records{
        {{"bench", "baseline"}, {"method", "baked"}, {"joints", 40}, {"file", "a.glb"}, {"median_ms", 1}},
        {{"bench", "baseline"}, {"method", "baked"}, {"joints", 40}, {"file", "b.glb"}, {"median_ms", 1}},
        {{"bench", "update"}, {"scan", "serial"}, {"files", {{{"name", "a"}}}}, {"total", {{"median_ms", 1}}}},
        {{"bench", "update"}, {"scan", "serial"}, {"files", {{{"name", "b"}}}}, {"total", {{"median_ms", 1}}}},
        {{"bench", "control"}, {"characters", 9}, {"path", "fused"}, {"control_ms", times}},
        {{"bench", "control"}, {"characters", 9}, {"path", "native, fused"}, {"control_ms", times}}};
    const std::string text = summary_text(records, {});
    for (const char* row :
         {"| 40 joints, a.glb | baked |", "| 40 joints, b.glb | baked |", "| a | serial |", "| b | serial |",
          "| 9 characters | fused, the control stage |", "| 9 characters | native, fused, the control stage |"})
        EXPECT_EQ(count_of(text, row), 1u) << row << text;
}

TEST(Summary, EachDeviceHasAHeadingOfItsOwn) {
    const auto record = [](const char* bench, const char* device, double ms) {
        return Json{{"bench", bench}, {"configuration", "a"}, {"device", device}, {"ms", {{"median", ms}}}};
    };
    const std::string text = summary_text(std::vector{record("view", "One", 1), record("view", "Two", 2),
                                                      record("view", "One", 3), record("frame", "One", 4)},
                                          {});
    const size_t one = text.find("\n## One\n"), two = text.find("\n## Two\n");
    ASSERT_LT(one, two);
    ASSERT_NE(two, std::string::npos) << text;
    EXPECT_EQ(count_of(text, "\n## "), 2u);
    EXPECT_EQ(count_of(text, "\n### view\n"), 2u);
    for (const char* ms : {"| 1.00 |", "| 3.00 |", "| 4.00 |"}) EXPECT_LT(text.find(ms), two) << text;
    EXPECT_GT(text.find("| 2.00 |"), two) << text;
    EXPECT_EQ(count_of(summary_section(std::vector{record("view", "Two", 2)}), "<td>Two</td>"), 1u);
}

TEST(Summary, PredictionsAreForOneDevice) {
    const auto is_predicted = [](const char* machine, const char* device) {
        Json record{{"bench", "frame"},    {"variant", "fused"},      {"path", "fused"},
                    {"subgroup_size", 32}, {"ms", {{"median", 0.3}}}, {"device", device}};
        Json prediction = record;
        prediction.update({{"kernel", "fused, two clips"}, {"machine", machine}, {"predicted_ms", 0.1}});
        return summary_text(std::vector<Json>{record}, std::vector<Json>{prediction}).find("| 0.100 | 3.00 |") !=
               std::string::npos;
    };
    EXPECT_TRUE(is_predicted("RX 7900 XTX", "AMD Radeon RX 7900 XTX (RADV GFX1100)"));
    EXPECT_FALSE(is_predicted("RX 7900 XTX", "AMD Radeon RX 7900 XT (RADV GFX1100)"));
    EXPECT_TRUE(is_predicted("RTX 3080", "NVIDIA GeForce RTX 3080"));
    EXPECT_FALSE(is_predicted("RTX 3080", "NVIDIA GeForce RTX 3080 Ti"));
    EXPECT_TRUE(is_predicted("H100 SXM", "NVIDIA H100 80GB HBM3"));
    EXPECT_FALSE(is_predicted("H100 SXM", "NVIDIA H100 PCIe"));
    EXPECT_FALSE(is_predicted("H100 SXM", "NVIDIA H100 NVL"));
    EXPECT_FALSE(is_predicted("RX 6900 XT", "AMD Radeon RX 6900M"));
    EXPECT_FALSE(is_predicted("Steam Deck", "AMD Custom GPU 0405 (RADV VANGOGH)"));
}

TEST(Summary, AMillionIsPredictedByItsOwnRecords) {
    const Json record{{"bench", "million"},
                      {"view", "corner"},
                      {"configuration", "a million"},
                      {"ms", {{"median", 0.3}}},
                      {"device", "NVIDIA GeForce RTX 3080"}},
        prediction{{"bench", "million"},
                   {"view", "corner"},
                   {"configuration", "a million"},
                   {"machine", "RTX 3080"},
                   {"predicted_ms", 0.1}};
    Json of_other_view = prediction;
    of_other_view["view"] = "from above";
    const auto summary = [&](const Json& predicted) {
        return summary_text(std::vector<Json>{record}, std::vector<Json>{predicted});
    };
    EXPECT_EQ(count_of(summary(prediction), "| 0.100 | 3.00 |"), 1u) << summary(prediction);
    EXPECT_EQ(count_of(summary(prediction), "a million | corner"), 1u);
    EXPECT_EQ(count_of(summary(of_other_view), "| 0.100 |"), 0u);
}

TEST(Summary, PredictionsAreNotMeasuredTimes) {
    const Json of_machine_code{{"bench", "million"}, {"configuration", "a million"}, {"family", "navi21"}};
    Json prediction = of_machine_code, none = of_machine_code;
    prediction.update({{"machine", "RTX 3080"}, {"ms", {{"median", 0.1}}}});
    none["unsupported_reason"] = "the character is updated stage by stage";
    EXPECT_TRUE(measured_times(std::vector<Json>{prediction, none}, {}).empty());
}

TEST(Summary, ScansArePredictedInMemoryAndOfTheSameSkeleton) {
    const Json record{{"bench", "scan"},     {"experiment", "levels"}, {"method", "stream"}, {"shape", "random"},
                      {"seed", 1},           {"characters", 10'000},   {"joints", 300},      {"levels", 60},
                      {"threads", 32},       {"median_ms", 0.3},       {"p5_ms", 0.2},       {"p95_ms", 0.4},
                      {"device", "RTX 3080"}},
        prediction{{"bench", "isa"},     {"configuration", "scan alone, 300 joints, 60 levels"},
                   {"scan", "stream"},   {"shape", "random"},
                   {"seed", 1},          {"characters", 10'000},
                   {"joints", 300},      {"levels", 60},
                   {"threads", 4},       {"machine", "RTX 3080"},
                   {"predicted_ms", 0.1}};
    const auto is_predicted_by = [&](const char* field, const Json& value) {
        Json other = prediction;
        other[field] = value;
        return count_of(summary_text(std::vector<Json>{record}, std::vector<Json>{other}), "| 0.100 | 3.00 |") == 1;
    };
    EXPECT_TRUE(is_predicted_by("threads", 8)) << "each has those that are the fastest";
    EXPECT_FALSE(is_predicted_by("configuration", "scan on chip, 300 joints, 60 levels"));
    EXPECT_FALSE(is_predicted_by("scan", "stream_quaternion"));
    EXPECT_FALSE(is_predicted_by("shape", "comb"));
    EXPECT_FALSE(is_predicted_by("machine", "H100 SXM"));
    for (const char* field : {"seed", "characters", "joints", "levels"})
        EXPECT_FALSE(is_predicted_by(field, 7)) << field;
}

TEST(Report, NamesTheLineOfAnInvalidRecord) {
    const auto read = [](const std::string& content) {
        const TemporaryFolder folder;
        return read_records(folder.write("records.jsonl", content));
    };
    EXPECT_EQ(read("{\"bench\": \"scan\"}\n\n{\"bench\": \"update\"}").size(), 2u);
    EXPECT_NE(failure_of([&] { read("{}\n\n{\"bench\": \n"); }).find(".jsonl:3: "), std::string::npos);
    EXPECT_NE(failure_of([&] { read("{}\n7"); }).find(".jsonl:2: "), std::string::npos);
    EXPECT_NE(failure_of([] { read_records("nowhere.jsonl"); }).find("nowhere.jsonl: "), std::string::npos);
}

TEST(Report, WritesNumbersWithThreeDigits) {
    EXPECT_EQ(digits(0.01234), "0.0123");
    EXPECT_EQ(digits(1.2345), "1.23");
    EXPECT_EQ(digits(12.345), "12.3");
    EXPECT_EQ(digits(123.45), "123");
    EXPECT_EQ(digits(1234567.8), "1,234,568");
    EXPECT_EQ(digits(3.04e-7), "3.0e-07");
    EXPECT_EQ(digits(-0.5), "-0.500");
    EXPECT_EQ(digits(0), "0");
    EXPECT_EQ(digits(std::nan("")), "–");
    EXPECT_EQ(whole(-1234), "-1,234");
}

}  // namespace
}  // namespace throng::bench
