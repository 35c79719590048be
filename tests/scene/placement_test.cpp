// Formations: they have the requested number of places, keep them apart, are reproducible from a seed, and mix the
// characters.
#include "tools/cli/command.h"
#include "tools/scene/scatter.h"

#include <gtest/gtest.h>

#include <limits>

namespace throng::tools {
namespace {

using creature::Random;

constexpr Formation kFormations[] = {Formation::kGrid, Formation::kDisc, Formation::kPath, Formation::kRandom};

std::vector<Place> placed(Formation formation, const std::vector<PlacementKind>& kinds, uint64_t seed = 1) {
    Random random(seed);
    return place(formation, kinds, random);
}

std::vector<double> pitches_of(const std::vector<PlacementKind>& kinds) {
    std::vector<double> pitches;
    for (const PlacementKind& kind : kinds) pitches.insert(pitches.end(), kind.count, kind.pitch);
    return pitches;
}

// The smallest distance between two places, relative to half the sum of their pitches.
double least_apart(const std::vector<Place>& places, const std::vector<double>& pitches) {
    double least = std::numeric_limits<double>::infinity();
    for (size_t i = 0; i < places.size(); ++i)
        for (size_t j = 0; j < i; ++j)
            least = std::min(least, std::hypot(places[i].x - places[j].x, places[i].z - places[j].z) /
                                        ((pitches[i] + pitches[j]) / 2));
    return least;
}

double extent(const std::vector<Place>& places) {
    double most = 0;
    for (const Place& place : places) most = std::max(most, std::hypot(place.x, place.z));
    return most;
}

bool equal(const std::vector<Place>& a, const std::vector<Place>& b) {
    return std::ranges::equal(a, b, [](const Place& p, const Place& q) {
        return p.x == q.x && p.z == q.z && p.heading_turns == q.heading_turns;
    });
}

TEST(Placement, PlacesDoNotOverlapForAnyCount) {
    for (const Formation formation : kFormations)
        for (const uint32_t count : {1u, 2u, 3u, 7u, 10u, 100u, 1500u}) {
            const std::vector<PlacementKind> kinds{{count, 0.7}};
            const std::vector<Place> places = placed(formation, kinds);
            ASSERT_EQ(places.size(), count);
            EXPECT_GE(least_apart(places, pitches_of(kinds)), 1 - 1e-9) << int(formation) << ", " << count;
            EXPECT_LE(extent(places), 0.7 * (1.6 * std::sqrt(count) + 2)) << int(formation) << ", " << count;
        }
}

TEST(Placement, EachKindHasEnoughSpace) {
    const std::vector<PlacementKind> kinds{{800, 1}, {5, 12.5}, {0, 30}, {40, 4}, {100, 1}};
    for (const Formation formation : kFormations) {
        const std::vector<Place> places = placed(formation, kinds);
        ASSERT_EQ(places.size(), 945u);
        EXPECT_GE(least_apart(places, pitches_of(kinds)), 1 - 1e-9) << int(formation);
    }
}

TEST(Placement, IsTheSameForTheSameSeed) {
    const std::vector<PlacementKind> kinds{{50, 1}, {9, 3}};
    for (const Formation formation : kFormations) {
        EXPECT_TRUE(equal(placed(formation, kinds, 5), placed(formation, kinds, 5))) << int(formation);
        EXPECT_FALSE(equal(placed(formation, kinds, 5), placed(formation, kinds, 6))) << int(formation);
    }
}

TEST(Placement, KindsAreMixed) {
    for (const Formation formation : kFormations) {
        const std::vector<Place> places = placed(formation, {{200, 1}, {200, 1}});
        double x = 0;
        for (size_t i = 0; i < 200; ++i) x += (places[i].x - places[200 + i].x) / 200;
        EXPECT_LT(std::abs(x), extent(places) / 4) << int(formation);
    }
}

TEST(Placement, AGridIsSquareAndRowByRow) {
    const std::vector<Place> places = placed(Formation::kGrid, {{7, 2}});
    ASSERT_EQ(places.size(), 7u);
    for (size_t i = 0; i < 7; ++i) {
        EXPECT_EQ(places[i].x, (double(i % 3) - 1) * 2);
        EXPECT_EQ(places[i].z, (double(i / 3) - 1) * 2);
        EXPECT_EQ(places[i].heading_turns, 0);
    }
}

TEST(Placement, HeadingsFollowTheFormation) {
    for (const Place& place : placed(Formation::kDisc, {{100, 1}})) {
        const double radius = std::hypot(place.x, place.z);
        EXPECT_NEAR(creature::sine(place.heading_turns), place.x / radius, 1e-9);
        EXPECT_NEAR(creature::cosine(place.heading_turns), place.z / radius, 1e-9);
    }
    // On a path, characters look along it: in a single lane, the next one is straight ahead.
    const std::vector<Place> lane = placed(Formation::kPath, {{12, 1}});
    for (size_t i = 0; i + 1 < lane.size(); ++i) {
        const double dx = lane[i + 1].x - lane[i].x, dz = lane[i + 1].z - lane[i].z;
        const double ahead = (dx * creature::sine(lane[i].heading_turns) +
                              dz * creature::cosine(lane[i].heading_turns)) /
                             std::hypot(dx, dz);
        EXPECT_GT(ahead, 0.8) << i;
    }
}

TEST(Placement, HugeOrNonFinitePitchesAreRefused) {
    for (const double pitch :
         {1e200, std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()})
        EXPECT_THROW(placed(Formation::kGrid, {{4, pitch}}), CommandError) << pitch;
}

Character of_clips(size_t count) {
    Character character;
    character.bounds_max = {1, 2, 1};
    character.size = 2;
    for (size_t i = 0; i < count; ++i) character.clips.push_back({.duration_s = 1 + static_cast<float>(i)});
    return character;
}

TEST(Scatter, CharactersKeepTheirClipsForAnyCount) {
    const std::vector<Character> characters{of_clips(5), of_clips(3)};
    const Scatter few = scatter(characters, {.counts = {6, 4}}), many = scatter(characters, {.counts = {50, 70}});
    const auto same = [](const Playback& a, const Playback& b) {
        return std::tuple(a.first.clip, a.first.time_s, a.second.clip, a.second.time_s, a.weight) ==
               std::tuple(b.first.clip, b.first.time_s, b.second.clip, b.second.time_s, b.weight);
    };
    for (size_t i = 0; i < 6; ++i) EXPECT_TRUE(same(few.playback[i], many.playback[i])) << i;
    for (size_t i = 0; i < 4; ++i) EXPECT_TRUE(same(few.playback[6 + i], many.playback[50 + i])) << i;
    EXPECT_FALSE(same(few.playback[0], few.playback[1]));
    EXPECT_FALSE(same(few.playback[0], scatter(characters, {.counts = {6, 4}, .seed = 2}).playback[0]));
}

TEST(Scatter, AcceptsTheLargestBounds) {
    Character character = of_clips(1);
    character.bounds_min.x = -3e38f;
    character.bounds_max.x = 3e38f;
    EXPECT_EQ(scatter({&character, 1}, {.counts = {4}}).placement.size(), 4u);
}

TEST(Placement, AHundredThousandAtRandom) { EXPECT_EQ(placed(Formation::kRandom, {{100'000, 1}}).size(), 100'000u); }

}  // namespace
}  // namespace throng::tools
