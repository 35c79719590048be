// In which order updates tell what has happened.
#include "tests/lively_crowd.h"
#include "tests/subset.h"

#include <gtest/gtest.h>

#include <array>
#include <tuple>

namespace throng::test {
namespace {

const InSubset kFeedbackNatively({Subset::kNative}, {"Feedback.*"});

// The events are numbered against the order of their times, and of their layers.
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

}  // namespace
}  // namespace throng::test
