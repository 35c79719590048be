// The benchmark of instances that are spawned and despawned: all of its crowds are checked before they are timed, also
// after births and deaths, and wrong ones are not timed.
#include "bench/population_bench.h"
#include "tests/test_device.h"
#include "tools/creatures/creature.h"

#include <nlohmann/json.hpp>

#include <string>
#include <vector>

namespace throng::bench {
namespace {

std::vector<Json> measure_coming_and_going(const SkinReference& reference = skin_reference_of) {
    constexpr uint32_t kCapacity = 80;
    const Character character = *compile_character(
        *make_creature({.joint_count = 30, .level_count = 10, .face_count = 300}));
    std::vector<Playback> playback;
    for (uint32_t i = 0; i < kCapacity; ++i) playback.push_back({.first = {.clip = i % 3, .time_s = 0.013 * i}});
    const std::vector<Affine> placement(kCapacity);
    return measure_population(
        test_device(), {.configuration = "80", .character = &character, .playback = playback, .placement = placement},
        2, [](const std::string&) {}, reference);
}

TEST(PopulationBench, PosesAreRightAfterSpawnsAndDespawns) {
    size_t of_turnovers = 0;
    for (const Json& record : measure_coming_and_going()) {
        EXPECT_LE(record["max_error"], kSkinErrorBound) << record;
        EXPECT_FALSE(record.contains("wrong")) << record;
        EXPECT_EQ(record["samples"], 2) << record;
        of_turnovers += record.contains("frames_with") ? 1 : 0;
    }
    EXPECT_EQ(of_turnovers, 3u);
}

TEST(PopulationBench, AWrongResultIsNotTimed) {
    const auto off_by_a_thousandth = [](const Character& character, const Playback& playback) {
        std::vector<AffineT<double>> matrices = skin_reference_of(character, playback);
        matrices.back().row[1][2] += 1e-3;
        return matrices;
    };
    const std::vector<Json> records = measure_coming_and_going(off_by_a_thousandth);
    EXPECT_EQ(records.size(), 12u + 3u);
    for (const Json& record : records) {
        EXPECT_EQ(record["wrong"], true) << record;
        EXPECT_NEAR(record["max_error"].get<double>(), 1e-3, 1e-4) << record;
        for (const char* field : {"samples", "ms", "stages", "call_ms", "update_ms"})
            EXPECT_FALSE(record.contains(field)) << field << ": " << record;
    }
}

}  // namespace
}  // namespace throng::bench
