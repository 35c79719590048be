// The benchmark of updates for a view: every variant is measured, and wrong ones are not timed.
#include "bench/view_bench.h"
#include "tests/kernel_runner.h"
#include "tools/creatures/creature.h"

#include <nlohmann/json.hpp>

#include <map>
#include <numeric>

namespace throng::bench {
namespace {

using Json = nlohmann::json;

constexpr uint32_t kViewBenchCharacters = 60, kViewBenchJoints = 60;

// Characters in a row that leads away from the camera, every third behind it. The levels of detail claim `times_error`
// times their error.
std::map<std::string, Json> measure(float times_error, const Vec3<float>& target = {0, 0, -1}) {
    Character character = *compile_character(
        *make_creature({.joint_count = kViewBenchJoints, .level_count = 15, .face_count = 600}));
    for (Lod& level : character.lods) level.error *= times_error;
    std::vector<Playback> playback;
    std::vector<Affine> placement(kViewBenchCharacters);
    for (uint32_t i = 0; i < kViewBenchCharacters; ++i) {
        playback.push_back({.first = {.clip = i % 3, .time_s = 0.1 * i},
                            .second = {.clip = (i + 1) % 3, .time_s = 0.07 * i},
                            .weight = 0.1f + 0.01f * static_cast<float>(i)});
        placement[i].row[2][3] = character.size * 3 * static_cast<float>(2 + i) * (i % 3 == 0 ? 1.0f : -1.0f);
    }
    const auto view_of_row = [&](const Bounds& bounds) {
        EXPECT_GT(bounds.max.z, character.size * 100);
        return *view_of({.eye = {0, 0, 0}, .target = target}, 640, 360, bounds,
                        {.shadows = false, .full_rate_pixels = 100});
    };
    std::map<std::string, Json> records;
    for (const Json& record : measure_view(test_device(),
                                           {.configuration = "a row",
                                           .character = &character,
                                           .playback = playback,
                                           .placement = placement,
                                           .view_of = view_of_row},
                                           2, [](const std::string&) {}))
        EXPECT_TRUE(records.emplace(record["variant"], record).second);
    return records;
}

TEST(ViewBench, EveryVariantIsMeasured) {
    const std::map<std::string, Json> records = measure(1);
    ASSERT_EQ(records.size(), 4u);
    for (const auto& [variant, record] : records) {
        EXPECT_EQ(record["bench"], "view");
        EXPECT_EQ(record["configuration"], "a row");
        EXPECT_EQ(record["characters"], kViewBenchCharacters);
        EXPECT_EQ(record["joints"], kViewBenchJoints);
        EXPECT_EQ(record["samples"], 2);
        EXPECT_FALSE(record.contains("wrong")) << record;
        EXPECT_EQ(record.contains("lod_pixels"), variant != "everything");
        EXPECT_LE(record["max_error"], 1e-4);
        EXPECT_GT(record["stages"]["fused"], 0);
        EXPECT_EQ(record["stages"].contains("cull"), variant != "everything");
        EXPECT_EQ(record["stages"].contains("update_rate"), variant == "and fewer updates") << record;
        const std::vector<uint32_t> drawn = record["drawn"];
        EXPECT_EQ(std::accumulate(drawn.begin(), drawn.end(), 0u),
                  variant == "everything" ? kViewBenchCharacters : kViewBenchCharacters * 2 / 3);
        EXPECT_GT(drawn[0], 0u);
        EXPECT_GT(drawn.size(), variant == "everything" ? 0u : 1u);
        EXPECT_NEAR(record["times_faster"].get<double>(),
                    records.at("everything")["ms"]["median"].get<double>() / record["ms"]["median"].get<double>(),
                    1e-9);
    }
    EXPECT_GT(records.at("and fewer joints")["max_pixels"], 0) << "joints have been left out";
    EXPECT_GT(records.at("and fewer updates")["memory_bytes"], records.at("and fewer joints")["memory_bytes"]);
    EXPECT_EQ(records.at("and fewer updates")["full_rate_pixels"], 100);
}

// The understated errors make joints be left out of characters right in front of the camera.
TEST(ViewBench, AWrongResultIsNotTimed) {
    const std::map<std::string, Json> records = measure(0.001f);
    for (const char* variant : {"and fewer joints", "and fewer updates"}) {
        EXPECT_EQ(records.at(variant)["wrong"], true) << records.at(variant);
        EXPECT_GT(records.at(variant)["max_pixels"], 1);
        for (const char* field : {"ms", "stages", "samples", "times_faster"})
            EXPECT_FALSE(records.at(variant).contains(field)) << field;
    }
    for (const char* variant : {"everything", "culled"})
        EXPECT_TRUE(records.at(variant).contains("ms")) << "fewer triangles of all joints";
}

TEST(ViewBench, AViewWithoutInstancesIsNotTimed) {
    const std::map<std::string, Json> records = measure(1, {0, 1, -0.01f});
    for (const char* variant : {"culled", "and fewer joints", "and fewer updates"}) {
        EXPECT_NE(records.at(variant)["unsupported_reason"].get<std::string>().find("sees none"), std::string::npos);
        EXPECT_FALSE(records.at(variant).contains("ms"));
    }
    EXPECT_TRUE(records.at("everything").contains("ms"));
}

}  // namespace
}  // namespace throng::bench
