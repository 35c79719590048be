// Events of controllers, and time steps of any size; as controller_test.cpp.
#include "tests/host/controller_states.h"

#include <gtest/gtest.h>

namespace throng {
namespace {

using namespace test;

Controller with_events(bool loop, float speed = 1,
                       std::vector<ControllerEvent> events = {{"end", "a", 1}, {"half", "a", 0.5}, {"start", "a", 0}}) {
    Controller controller{.name = "test", .events = std::move(events)};
    controller.layers = {{.name = "base", .states = {clip_state("a", loop, speed)}}};
    return controller;
}

TEST(Controller, EventsArePassedOnceInEachCycle) {
    Instance instance(with_events(true));
    instance.update(0);
    EXPECT_EQ(instance.events(), "");
    instance.update(0.5f);
    EXPECT_EQ(instance.events(), "start@0") << "up to 0.5, which is not included";
    instance.update(0.25f);
    EXPECT_EQ(instance.events(), "half@0");
    instance.update(2);
    EXPECT_EQ(instance.events(), "end@0.25 start@0.25 half@0.75 end@1.25 start@1.25 half@1.75");
    instance.update(0.125f);
    EXPECT_EQ(instance.events(), "");
}

TEST(Controller, BackwardPlaysPassEventsInReverse) {
    Instance instance(with_events(true, -1));
    instance.update(0.5f);
    EXPECT_EQ(instance.events(), "half@0.5") << "the end is where it begins";
    instance.update(1.25f);  // from 0.5 down to 0.25 of the cycle before
    EXPECT_EQ(instance.events(), "start@0.5 end@0.5 half@1");
    instance.update(-0.5f);  // backwards from a backward state is forward
    EXPECT_EQ(instance.events(), "half@0.25");
    EXPECT_EQ(instance.leading().loops, 1u) << "of those backwards";
}

TEST(Controller, EndEventsArePassedOnce) {
    Instance instance(with_events(false));
    instance.update(0.75f);
    EXPECT_EQ(instance.events(), "start@0 half@0.5");
    instance.update(0.75f);
    EXPECT_EQ(instance.events(), "end@0.25");
    for (int i = 0; i < 3; ++i) {
        instance.update(0.75f);
        EXPECT_EQ(instance.events(), "");
    }
    EXPECT_EQ(instance.leading().phase, io::kLastPhase);
    instance.update(-3);
    EXPECT_EQ(instance.events(), "half@0.5 start@1");
    instance.update(-3);
    EXPECT_EQ(instance.events(), "");
    EXPECT_EQ(instance.leading().phase, 0u);
    instance.update(0.999f);
    EXPECT_EQ(instance.events(), "start@0 half@0.5");
    instance.update(0.001f);
    instance.update(0.001f);
    EXPECT_EQ(instance.leading().phase, io::kLastPhase);
}

TEST(Controller, OnlyTheHeaviestClipOfTheLeadingPlayHasEvents) {
    Controller controller = three_states({{.from = "a", .to = "b", .conditions = kGo, .fade_s = 1}});
    controller.events = {{"a", "a", 0.25}, {"b", "b", 0.5}, {"c", "c", 1}};
    controller.layers[0].states[1].points = {{"b", 0}, {"c", 1}};
    controller.layers[0].states[1].x_parameter = "x";
    Instance instance(controller);
    instance.update(0.5f);
    EXPECT_EQ(instance.events(), "a@0.25");
    instance.set("go", 1);
    instance.set("x", 0.5f);
    instance.update(0.75f);
    EXPECT_EQ(instance.events(), "b@0.666667")
        << "the first of equals; a, at 0.25 of the next cycle, has none any more";
    controller.layers[0].weight = 0;
    Instance unseen(controller);
    unseen.update(1);
    EXPECT_EQ(unseen.events(), "");
}

TEST(Controller, ManyCyclesInOneStep) {
    Instance instance(with_events(true));
    instance.update(1000.5f);
    EXPECT_EQ(instance.leading().loops, 1000u);
    EXPECT_EQ(instance.leading().phase, kHalfCycle);
    EXPECT_EQ(instance.last.events.size(), 3u * 1000 + 1);
    instance.update(-2000);
    EXPECT_EQ(instance.leading().loops, 0u) << "not below 0";
    EXPECT_EQ(instance.last.events.size(), 6000u);
}

TEST(Controller, ExtremeStepsLeaveAValidState) {
    Controller controller = with_events(true, 3e38f, {});
    controller.parameters = {{"x"}};
    controller.layers[0].states[0].speed_parameter = "x";
    Instance instance(controller, {1e-3f});
    for (const float x : {0.0f, 1.0f, -1.0f, 1e30f}) {
        instance.set("x", x);
        for (int i = 0; i < 3; ++i) instance.update(1e6f);
        EXPECT_LE(instance.leading().loops, 1'000'000'000u);
    }
}

TEST(Controller, AStepTooSmallForAFloatIsNoStep) {
    Instance instance(with_events(true));
    instance.update(2);
    for (int i = 0; i < 1000; ++i) {
        instance.update(-1e-12f);  // 1 - 1e-12 is 1
        EXPECT_EQ(instance.events(), "");
    }
    EXPECT_EQ(instance.leading().loops, 2u);
    EXPECT_EQ(instance.leading().phase, 0u);
}

TEST(Controller, ANanRateStopsThePlay) {
    Controller controller = with_events(true, 3e38f, {});
    controller.parameters = {{"x", ParameterType::kFloat, 1}};
    controller.layers[0].states[0].speed_parameter = "x";
    Instance instance(controller, {1e-3f});
    instance.update(1);
    EXPECT_EQ(instance.leading().loops, 1'000'000'000u) << "the most";
    instance.set("x", 0);  // infinity * 0
    instance.update(1);
    EXPECT_EQ(instance.leading().loops, 1'000'000'000u);
    EXPECT_EQ(instance.leading().phase, 0u);
}

TEST(Controller, AClipWithoutDurationStands) {
    Controller controller = with_events(false, 1, {{"now", "a", 0}});
    Instance instance(controller, {0});
    for (int i = 0; i < 3; ++i) {
        instance.update(10);
        EXPECT_EQ(instance.events(), "");
        EXPECT_EQ(instance.leading().phase, 0u);
        EXPECT_EQ(instance.last.active_clips[0].time_s, 0);
    }
}

}  // namespace
}  // namespace throng
