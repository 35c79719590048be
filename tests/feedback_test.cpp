// The order in which feedback reports events, and what it says about playback.
#include "tests/lively_crowd.h"
#include "tests/subset.h"

#include <gtest/gtest.h>

#include <array>
#include <tuple>

namespace throng::test {
namespace {

const InSubset kFeedbackNatively({Subset::kNative}, {"Feedback.*"});

// The events are numbered in the opposite order of their times and layers.
TEST(Feedback, EventsComeByInstanceThenLayerThenTime) {
    const Character character = creature(20, 8);
    const std::string &lower = character.clips[0].name, &upper = character.clips[1].name;
    const auto layer = [](const char* name, const std::string& clip) {
        return ControllerLayer{.name = name, .states = {{.name = "state", .points = {{.clip = clip}}}}};
    };
    const Controller controller{.events = {{.name = "above", .clip = upper, .time_s = 0.05},
                                           {.name = "late", .clip = lower, .time_s = 0.3},
                                           {.name = "early", .clip = lower, .time_s = 0.1}},
                                .layers = {layer("lower", lower), layer("upper", upper)}};
    Crowd crowd = create({.groups = {{.character = &character, .instance_count = 2, .controller = &controller}}});
    ASSERT_TRUE(crowd.update(0.4f));
    std::vector<std::tuple<uint32_t, uint32_t, uint32_t>> got, wanted;
    std::vector<float> times_s;
    for (const CharacterEvent& event : feedback_of(crowd).events) {
        got.emplace_back(event.instance.instance, event.layer, event.event);
        times_s.push_back(event.time_s);
    }
    for (const uint32_t instance : {0u, 1u})
        for (const auto& [of_layer, event] : {std::pair{0u, 2u}, {0u, 1u}, {1u, 0u}})
            wanted.emplace_back(instance, of_layer, event);
    EXPECT_EQ(got, wanted);
    constexpr std::array kTimes_s{0.1f, 0.3f, 0.05f};
    for (size_t i = 0; i < times_s.size(); ++i) EXPECT_NEAR(times_s[i], kTimes_s[i % 3], 1e-5f) << i;
}

// What a game needs to make another instance play the same. A state has its own speed and loop setting.
TEST(Feedback, ReportsSpeedLoopAndWeight) {
    const Character character = creature(20, 8);
    const Controller direct = direct_layers(2);
    const Controller stated{
        .layers = {
            {.name = "all",
             .states = {{.name = "one", .points = {{.clip = character.clips[0].name}}, .loop = false, .speed = 3}}},
            {.name = "over",
             .weight = 0.25f,
             .states = {{.name = "two", .points = {{.clip = character.clips[1].name}}}}}}};
    Crowd crowd = create({.groups = {{.character = &character, .instance_count = 1, .controller = &direct},
                                     {.character = &character, .instance_count = 1, .controller = &stated}}});
    const InstanceHandle told{0};
    ASSERT_TRUE(crowd.play(told, 0, {.clip = {.clip = 0, .speed = -1.5f, .loop = false}}));
    ASSERT_TRUE(crowd.play(told, 1, {.clip = {.clip = 1, .speed = 2}}));
    ASSERT_TRUE(crowd.set_layer(told, 1, {.weight = 0, .fade_s = 0.4f}));
    ASSERT_TRUE(crowd.watch(std::array{InstanceHandle{1}, told}));
    ASSERT_TRUE(crowd.update(0.1f));
    const Feedback feedback = feedback_of(crowd);
    const WatchedInstance &of_states = feedback.watched.at(0), &of_clips = feedback.watched.at(1);
    EXPECT_EQ(of_clips.layers[0][0].speed, -1.5f);
    EXPECT_FALSE(of_clips.layers[0][0].loop);
    EXPECT_EQ(of_clips.layers[1][0].speed, 2);
    EXPECT_TRUE(of_clips.layers[1][0].loop);
    ASSERT_EQ(of_clips.layer_weights.size(), 2u);
    EXPECT_EQ(of_clips.layer_weights[0], 1);
    EXPECT_NEAR(of_clips.layer_weights[1], 0.75f, 1e-6f);
    EXPECT_EQ(of_states.layers[0][0].speed, 1);
    EXPECT_TRUE(of_states.layers[0][0].loop);
    EXPECT_EQ(copy_of(of_states.layer_weights), (std::vector{1.0f, 0.25f}));
}

// Data of instances with consecutive numbers is copied together: here of 0, 1 and 1, 2 in one group, of 4 and 4, 5 in
// the other.
TEST(Feedback, KeepsTheOrderOfTheCallAndRepeatedInstances) {
    const Character character = creature(20, 8);
    const Controller controller = direct_layers(1);
    Crowd crowd = create({.groups = {{.character = &character, .instance_count = 3, .sockets = {1, 3}},
                                     {.character = &character, .instance_count = 3, .controller = &controller}}});
    for (uint32_t i = 0; i < crowd.instance_count(); ++i) {
        const Trs<float> place{.translation = {static_cast<float>(10 * i), 0, 0}};
        ASSERT_TRUE(crowd.set_placement(InstanceHandle{i}, to_affine(place)));
    }
    const std::vector<InstanceHandle> asked{{4}, {1}, {0}, {5}, {1}, {2}, {4}};
    ASSERT_TRUE(crowd.watch(asked));
    const std::vector<std::byte> saved = crowd.save_state().value();
    const auto expect_right = [&] {
        ASSERT_TRUE(crowd.update(0.1f));
        const Feedback feedback = feedback_of(crowd);
        ASSERT_EQ(feedback.watched.size(), asked.size());
        for (size_t i = 0; i < asked.size(); ++i) {
            const WatchedInstance& watched = feedback.watched[i];
            const float x = 10 * static_cast<float>(asked[i].instance);
            EXPECT_EQ(watched.instance, asked[i]) << i;
            EXPECT_EQ(watched.world_from_model.row[0][3], x) << i;
            EXPECT_EQ(watched.sockets.size(), asked[i].instance < 3 ? 2u : 0u) << i;
            for (const Affine& world_from_joint : watched.sockets) EXPECT_NEAR(world_from_joint.row[0][3], x, 5) << i;
            EXPECT_EQ(watched.layers.size(), asked[i].instance < 3 ? 0u : 1u) << i;
        }
    };
    expect_right();
    const Result<void> restored = crowd.restore_state(saved);
    ASSERT_TRUE(restored) << restored.error().text();
    expect_right();
}

}  // namespace
}  // namespace throng::test
