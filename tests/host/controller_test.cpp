// The rules of docs/controller.md, one at a time, with one instance and results worked out by hand.
#include "control/control_reference.h"
#include "control/layer_commands.h"
#include "tests/controller_instance.h"

#include <gtest/gtest.h>

#include <limits>

namespace throng {
namespace {

using namespace test;
using When = ControllerCondition::Test;

constexpr uint32_t kHalf = 0x80000000u, kQuarter = 0x40000000u;

ControllerState one_clip(std::string name, bool loop = true, float speed = 1) {
    return {.name = name, .points = {{name}}, .loop = loop, .speed = speed};
}

// States a, b, c, each with the clip of the same name.
Controller three_states(std::vector<ControllerTransition> transitions, bool loop = true) {
    Controller controller{.name = "test",
                          .parameters = {{"go", ParameterType::kTrigger}, {"x"}, {"on", ParameterType::kBool}}};
    controller.layers = {{.name = "base",
                          .states = {one_clip("a", loop), one_clip("b", loop), one_clip("c", loop)},
                          .transitions = std::move(transitions)}};
    return controller;
}
const std::vector<ControllerCondition> kGo{{"go", When::kTriggered}};

TEST(Controller, BeginsInTheFirstStateWithoutFade) {
    Instance instance(three_states({{.from = "a", .to = "b"}}));
    instance.update(0);
    EXPECT_EQ(instance.weights(), (std::vector<float>{1, 0, 0}));
    EXPECT_EQ(instance.play_count(), 1u);
    instance.update(0);
    EXPECT_EQ(instance.weights(), (std::vector<float>{0, 1, 0}));
}

TEST(Controller, FadesAreLinearInTimeAndEased) {
    Instance instance(three_states({{.from = "a", .to = "b", .conditions = kGo, .fade_s = 1}}));
    instance.update(0.125f);
    instance.set("go", 1);
    instance.update(0.25f);
    EXPECT_EQ(instance.weights(), (std::vector<float>{1 - 0.15625f, 0.15625f, 0}));  // 0.25^2 (3 - 0.5)
    EXPECT_EQ(instance.last.active_clips[0].clip, 1u) << "the newest first";
    EXPECT_EQ(instance.leading().phase, kQuarter / 2) << "what begins has all of the step: 0.25 of 2 s";
    EXPECT_EQ(instance.reference.layers[0].plays[1].phase, kQuarter + kQuarter / 2) << "what fades out goes on";
    instance.update(0.25f);
    EXPECT_EQ(instance.weights(), (std::vector<float>{0.5f, 0.5f, 0}));
    instance.update(-0.25f);
    EXPECT_EQ(instance.weights(), (std::vector<float>{0.5f, 0.5f, 0})) << "fades do not go back";
    instance.update(0.5f);
    EXPECT_EQ(instance.weights(), (std::vector<float>{0, 1, 0}));
    EXPECT_EQ(instance.play_count(), 1u);
    EXPECT_EQ(instance.reference.parameters[0], 0) << "the trigger is reset";
}

// Getting up is sitting down played backwards. Clip b lasts 2 s.
TEST(Controller, BackwardStatesBeginAtTheirEndAndCountExitsFromThere) {
    for (const bool loop : {false, true}) {
        Controller controller = three_states(
            {{.from = "a", .to = "b", .conditions = kGo}, {.from = "b", .to = "c", .exit = loop ? 1.25f : 1}}, loop);
        controller.layers[0].states[1].speed = -1;
        Instance instance(controller);
        instance.update(0);
        instance.set("go", 1);
        instance.update(0.5f);
        EXPECT_EQ(instance.leading().motion, 1u);
        EXPECT_EQ(instance.leading().phase, io::kLastPhase - kQuarter) << loop;
        instance.update(1);
        instance.update(0.25f);
        EXPECT_EQ(instance.leading().motion, 1u) << "not before its end";
        instance.update(0.25f);
        EXPECT_EQ(instance.leading().phase, loop ? io::kLastPhase : 0u);
        EXPECT_EQ(instance.leading().loops, loop ? 1u : 0u);
        if (loop) {
            instance.update(0.25f);
            EXPECT_EQ(instance.leading().motion, 1u) << "a quarter of a cycle more";
            instance.update(0.25f);
        }
        EXPECT_EQ(instance.leading().motion, 1u);
        instance.update(0);
        EXPECT_EQ(instance.leading().motion, 2u) << loop;
    }
}

TEST(Controller, AnUpdateHasNoMoreEventsThanACrowdKeeps) {
    for (const float speed : {1e30f, -1e30f}) {
        Controller controller = three_states({});
        controller.layers[0].states[0].speed = speed;
        controller.events = {{.name = "step", .clip = "a", .time_s = 0.25}};
        Instance instance(controller);
        instance.update(0.1f);
        ASSERT_EQ(instance.last.events.size(), kMaxEvents);
        EXPECT_LT(instance.last.events.back().time_s, 1e-5) << "the first of a billion";
    }
}

TEST(Controller, AFullStackOfThreePlaysDropsItsOldest) {
    Instance instance(direct_layers(1), {1, 1, 1, 1});
    for (uint32_t clip = 0; clip < 4; ++clip) {
        instance.play(clip, clip == 0 ? 0.0f : 1.0f);
        instance.update(clip < 3 ? 0.5f : 0.25f);
    }
    // Fades: play 3 is at 0.25 and play 2 at 0.75; play 1, the oldest, counts as 1.
    const float third = 0.15625f, second = 0.84375f;
    EXPECT_EQ(instance.weights(), (std::vector<float>{0, (1 - third) * (1 - second), (1 - third) * second, third}));
}

TEST(Controller, AFinishedFadeDropsThePlaysBelow) {
    Instance instance(direct_layers(1), {1, 1, 1});
    instance.play(0);
    instance.play(1, 4);
    instance.play(2, 1);
    instance.update(0.25f);  // play 1 has fully replaced 0; play 2 has begun
    EXPECT_EQ(instance.play_count(), 2u);
    EXPECT_EQ(instance.weights(), (std::vector<float>{0, 0.84375f, 0.15625f}));
}

TEST(Controller, TransitionsInterruptAFadeOnlyWhereTheySaySo) {
    for (const bool interrupts : {false, true}) {
        Instance instance(three_states(
            {{.from = "a", .to = "b", .fade_s = 1}, {.from = "b", .to = "c", .fade_s = 1, .interrupts = interrupts}}));
        instance.update(0);
        instance.update(0.25f);
        instance.update(0.25f);
        EXPECT_EQ(instance.leading().motion, interrupts ? 2u : 1u);
        EXPECT_EQ(instance.play_count(), interrupts ? 3u : 2u);
        instance.update(0.5f);
        instance.update(0);
        EXPECT_EQ(instance.leading().motion, 2u) << "when the fade has ended it needs no interruption";
    }
}

TEST(Controller, InertialTransitionsCutAndAreReported) {
    Instance instance(three_states({{.from = "a", .to = "b", .fade_s = 1, .fade = FadeKind::kInertial}}));
    instance.update(0);
    EXPECT_EQ(instance.reference.layers[0].taken, kNone);
    instance.update(0.125f);
    EXPECT_EQ(instance.weights(), (std::vector<float>{0, 1, 0}));
    EXPECT_NE(instance.reference.layers[0].taken, kNone);
    EXPECT_EQ(instance.leading().fade_rate, 1);
}

TEST(Controller, InertialTransitionsOfHiddenLayersHaveNoEffect) {
    Controller controller = three_states({});
    controller.layers.push_back(
        {.name = "unseen",
         .weight_parameter = "x",
         .states = {one_clip("b"), one_clip("c")},
         .transitions = {{.from = "b", .to = "c", .conditions = kGo, .fade_s = 1, .fade = FadeKind::kInertial}}});
    for (const float weight : {0.0f, 0.5f}) {
        Instance instance(controller);
        instance.set("x", weight);
        instance.update(0.1f);
        instance.set("go", 1);
        instance.update(0.1f);
        EXPECT_EQ(instance.last.inertial_s, weight > 0 ? 1 : 0);
    }
}

TEST(Controller, ExitWaitsForCycles) {
    Instance once(three_states({{.from = "a", .to = "b", .exit = 1}}, false));
    for (int i = 0; i < 4; ++i) once.update(0.25f);
    EXPECT_EQ(once.leading().motion, 0u);
    EXPECT_EQ(once.leading().phase, io::kLastPhase);
    once.update(0.25f);
    EXPECT_EQ(once.leading().motion, 1u);
    Instance looping(three_states({{.from = "a", .to = "b", .exit = 2.5f}}));
    for (int i = 0; i < 10; ++i) looping.update(0.25f);
    EXPECT_EQ(looping.leading().loops, 2u);
    EXPECT_EQ(looping.leading().phase, kHalf);
    EXPECT_EQ(looping.leading().motion, 0u);
    looping.update(0);
    EXPECT_EQ(looping.leading().motion, 1u);
}

TEST(Controller, TheFirstTransitionThatHoldsIsTakenAndOnlyOne) {
    Instance instance(
        three_states({{.from = "a", .to = "b", .conditions = {{"x", When::kAbove, 1}}},
                      {.from = "a", .to = "c", .conditions = {{"x", When::kAbove, 0}, {"on", When::kIsFalse}}},
                      {.from = "c", .to = "a", .conditions = {{"on", When::kIsTrue}}},
                      {.from = "b", .to = "a", .conditions = {{"x", When::kBelow, 1}}}}));
    instance.update(0);
    instance.update(100);
    EXPECT_EQ(instance.leading().motion, 0u) << "0 is not above 0";
    instance.set("x", 1);
    instance.update(0);
    EXPECT_EQ(instance.leading().motion, 2u);
    instance.set("on", 1);
    instance.set("x", 2);
    instance.update(0);
    EXPECT_EQ(instance.leading().motion, 0u) << "one a step";
    instance.update(0);
    EXPECT_EQ(instance.leading().motion, 1u) << "the first of two";
    instance.set("x", std::numeric_limits<float>::infinity());
    instance.update(0);
    EXPECT_EQ(instance.leading().motion, 0u) << "what is not finite counts as 0";
    instance.set("on", 0);
    instance.set("x", std::numeric_limits<float>::denorm_min());
    instance.update(0);
    EXPECT_EQ(instance.leading().motion, 0u) << "and so does what a device may take for 0";
    instance.set("x", std::numeric_limits<float>::min());
    instance.update(0);
    EXPECT_EQ(instance.leading().motion, 2u);
}

TEST(Controller, AStateCanBeSetAndContinuesFromThere) {
    Instance instance(
        three_states({{.from = "b", .to = "a", .exit = 2.75}, {.from = "c", .to = "a", .conditions = kGo}}));
    const auto put_into = [&](uint32_t state, uint32_t phase, uint32_t loops, float fade_rate = 0) {
        instance.reference.apply(
            {.kind = io::kCommandState, .motion = state, .phase = phase, .loop = loops, .fade_rate = fade_rate});
    };
    put_into(1, kHalf, 2);  // before the state has begun
    instance.update(0);
    EXPECT_EQ(instance.leading().motion, 1u);
    EXPECT_EQ(instance.leading().phase, kHalf);
    EXPECT_EQ(instance.leading().loops, 2u);
    instance.update(0.5f);  // half a second of 2 s
    instance.update(0);
    EXPECT_EQ(instance.leading().motion, 0u) << "2.75 cycles have been played";
    put_into(2, 0, 0, 1);
    instance.update(0.5f);
    EXPECT_EQ(instance.play_count(), 2u);
    EXPECT_EQ(instance.weights(), (std::vector<float>{0.5f, 0, 0.5f}));
    instance.update(1);
    put_into(2, 0, 0);
    instance.set("go", 1);
    instance.update(0);
    EXPECT_EQ(instance.leading().motion, 0u) << "in the same update";
}

// A rate that a device flushes to 0 would make the fade immediate.
TEST(Controller, TheLongestFadesHaveANonzeroRate) {
    const std::vector<LayerKind> kinds(1);
    const std::vector<float> durations_s{1};
    for (const float fade_s : {1e37f, 8e37f, 3e38f}) {
        const LayerPlayback playback{.clip = {.clip = 0}, .fade_s = fade_s};
        EXPECT_GE(play_command(kinds, durations_s, 0, playback, "here").fade_rate, std::numeric_limits<float>::min());
    }
}

TEST(Controller, AnyStateDoesNotLeadToItselfUnlessNamed) {
    Instance any(three_states({{.to = "a", .conditions = kGo}}));
    Instance named(three_states({{.from = "a", .to = "a", .conditions = kGo}}));
    for (Instance* instance : {&any, &named}) {
        instance->update(0.25f);
        instance->set("go", 1);
        instance->update(0.25f);
    }
    EXPECT_EQ(any.leading().phase, kHalf);
    EXPECT_EQ(any.reference.parameters[0], 1) << "not asked for, not reset";
    EXPECT_EQ(named.leading().phase, kQuarter);
    EXPECT_EQ(named.reference.parameters[0], 0);
}

TEST(Controller, ATriggerServesAllLayersOfOneUpdate) {
    Controller controller = three_states({{.from = "a", .to = "b", .conditions = kGo}});
    controller.layers.push_back(controller.layers[0]);
    controller.layers[1].name = "top";
    Instance instance(controller);
    instance.update(0);
    instance.set("go", 1);
    instance.update(0);
    EXPECT_EQ(instance.leading(0).motion, 1u);
    EXPECT_EQ(instance.leading(1).motion, 1u);
    EXPECT_EQ(instance.reference.parameters[0], 0);
}

// a (1 s) and b (2 s) are in one sync group, c (4 s) is not.
Controller synchronised() {
    Controller controller = three_states(
        {{.from = "a", .to = "b", .conditions = kGo, .fade_s = 1},
         {.from = "b", .to = "c", .conditions = {{"x", When::kAbove, 0}}, .fade_s = 1, .interrupts = true},
         {.from = "c", .to = "a", .conditions = {{"on", When::kIsTrue}}, .fade_s = 1, .interrupts = true}});
    controller.layers[0].states[0].sync = controller.layers[0].states[1].sync = "feet";
    return controller;
}

TEST(Controller, StatesOfASyncGroupKeepPhaseAndMixTheirRates) {
    Instance instance(synchronised());
    instance.update(3.75f);
    instance.set("go", 1);
    instance.update(0.5f);  // fade 0.5: weights 0.5 and 0.5, rates 1 and 0.5, so 0.375 of a cycle
    EXPECT_EQ(instance.leading().phase, kQuarter / 2);
    EXPECT_EQ(instance.leading().loops, 1u) << "since it was entered";
    EXPECT_EQ(instance.reference.layers[0].plays[1].phase, kQuarter / 2);
    EXPECT_EQ(instance.reference.layers[0].plays[1].loops, 1u);
    instance.update(0.5f);  // b alone, 0.25 of a cycle
    EXPECT_EQ(instance.leading().phase, kQuarter / 2 + kQuarter);
}

TEST(Controller, PlaysOutOfSyncKeepTheirOwnTime) {
    Instance instance(synchronised());
    instance.update(0);
    instance.set("go", 1);
    instance.update(1);  // b alone
    instance.set("x", 1);
    instance.update(0.5f);  // c fades in
    EXPECT_EQ(instance.leading().phase, kQuarter / 2) << "c keeps its own time";
    const uint32_t phase_of_b = instance.reference.layers[0].plays[1].phase;
    EXPECT_EQ(phase_of_b, kHalf + kQuarter);
    instance.set("on", 1);
    instance.update(0.5f);  // a fades in over c (at weight 1) and b (dropped), so there is no phase to take over
    EXPECT_EQ(instance.leading().phase, phase_of_b + static_cast<uint32_t>(0.5 * 0x1p32))
        << "b was still there when a was pushed; a then goes at its own rate of 1";
    EXPECT_EQ(instance.play_count(), 2u);
}

// A body that plays "a", and a layer above it that rests, or plays "b" (2 s, with an event at its beginning).
Controller body_and_gesture() {
    Controller controller = three_states({});
    controller.layers.push_back(
        {.name = "gesture",
         .weight = 0.5f,
         .states = {{.name = "rest"}, one_clip("b", false)},
         .transitions = {{.from = "rest", .to = "b", .conditions = kGo, .fade_s = 1},
                         {.from = "b", .to = "rest", .exit = 1, .fade_s = 1, .fade = FadeKind::kCross}}});
    controller.events = {{"begun", "b", 0}};
    return controller;
}

TEST(Controller, AStateThatPlaysNothingShowsTheLayersBelow) {
    Instance instance(body_and_gesture());
    const auto gesture = [&]() -> const ControllerActiveClip& { return instance.last.active_clips.back(); };
    instance.update(1);
    ASSERT_EQ(instance.last.active_clips.size(), 1u);
    EXPECT_EQ(gesture().layer, 0u);
    EXPECT_EQ(instance.leading(1).phase, 0u) << "nothing has no time";
    instance.set("go", 1);
    instance.update(0.5f);
    ASSERT_EQ(instance.last.active_clips.size(), 2u);
    EXPECT_EQ(gesture().clip, 1u);
    EXPECT_EQ(gesture().weight, 1) << "of the layer's clips it is the only one";
    EXPECT_EQ(gesture().layer_weight, 0.25f) << "half of the layer's weight, as the fade is half done";
    EXPECT_EQ(instance.events(), "begun@0");
    instance.update(0.5f);
    EXPECT_EQ(gesture().layer_weight, 0.5f);
    instance.update(1);      // to the clip's end
    instance.update(0.25f);  // the transition away has begun: eased, a quarter of the fade leaves 27/32
    EXPECT_EQ(gesture().layer_weight, 0.5f * 27 / 32);
    EXPECT_EQ(gesture().weight, 1);
    instance.update(0.75f);
    EXPECT_EQ(gesture().layer, 0u);
}

TEST(Controller, TwoPlaysOverNothingKeepTheirWeights) {
    Controller controller = three_states({{.from = "a", .to = "b", .conditions = kGo, .fade_s = 1},
                                          {.from = "b", .to = "c", .fade_s = 1, .interrupts = true}});
    controller.layers[0].states[0] = {.name = "a"};
    Instance instance(controller);
    instance.update(0);
    EXPECT_EQ(instance.last.active_clips[0].clip, 3u) << "the rest pose";
    instance.set("go", 1);
    instance.update(0.5f);   // b: 1/2
    instance.update(0.25f);  // c: 5/32; b: 27/32 of the rest, at a fade of 3/4
    const double c = 5.0 / 32, b = 27.0 / 32 * 27 / 32;
    ASSERT_EQ(instance.last.active_clips.size(), 3u);
    EXPECT_EQ(instance.last.active_clips[0].layer, kNone) << "the rest pose lies below a layer that does not cover it";
    EXPECT_NEAR(instance.weights()[2], c / (b + c), 1e-6);
    EXPECT_NEAR(instance.weights()[1], b / (b + c), 1e-6);
    EXPECT_NEAR(instance.last.active_clips[1].layer_weight, b + c, 1e-6);
}

TEST(Controller, APlayOfNothingStandsStill) {
    Character character = character_of({1, 2, 4});
    character.root_rows = {{0, 0, 1, 0}, {0, 2, 0, 1}};  // half a metre a quarter of the way, and a quarter turn
    character.clips[1].root_row_count = 2;
    Controller controller = three_states({{.from = "a", .to = "b", .conditions = kGo, .fade_s = 1}});
    controller.layers[0].states[0] = {.name = "a"};
    ControllerReference reference(controller, character);
    EXPECT_EQ(reference.update(1).move.z, 0);
    reference.apply({.kind = io::kCommandParameter, .target = 0, .value = 1});
    const GroundMove half = reference.update(0.5f).move;  // a quarter of "b", at half its weight
    ControllerReference alone(controller, character);
    alone.apply({.kind = io::kCommandState, .target = 0, .motion = 1});
    const GroundMove whole = alone.update(0.5f).move;
    EXPECT_GT(whole.z, 0.1);
    EXPECT_NEAR(half.z, whole.z / 2, 1e-6);
    EXPECT_NEAR(std::atan2(half.sin, half.cos), std::atan2(whole.sin, whole.cos) / 2, 1e-6)
        << "half as far, not just as far";
}

TEST(Controller, OneParameterMixesNeighbours) {
    Controller controller = three_states({});
    controller.layers[0].states = {
        {.name = "walk", .points = {{"a", 1}, {"b", 2}, {"c", 4}}, .x_parameter = "x", .speed = 2}};
    Instance instance(controller);
    const auto expect = [&](float x, std::vector<float> weights, float cycles) {
        const uint32_t before = instance.leading().phase;
        instance.set("x", x);
        instance.update(0.125f);
        EXPECT_EQ(instance.weights(), weights) << x;
        EXPECT_EQ(instance.leading().phase - before, static_cast<uint32_t>(cycles * 0x1p32f)) << x;
    };
    expect(-5, {1, 0, 0}, 0.25f);
    expect(1, {1, 0, 0}, 0.25f);
    expect(1.5f, {0.5f, 0.5f, 0}, 0.1875f);
    expect(2, {0, 1, 0}, 0.125f);
    expect(3.5f, {0, 0.25f, 0.75f}, 0.078125f);
    expect(4, {0, 0, 1}, 0.0625f);
    expect(1e30f, {0, 0, 1}, 0.0625f);
}

TEST(Controller, TwoParametersMixTriangles) {
    Controller controller = three_states({});
    controller.parameters.push_back({"speed"});
    controller.layers[0].states = {{.name = "walk",
                                    .points = {{"a", 0, 0}, {"b", 2, 0}, {"c", 0, 2}},
                                    .x_parameter = "x",
                                    .y_parameter = "on",
                                    .speed_parameter = "speed"}};
    Instance instance(controller);
    instance.set("x", 0.5f);
    instance.set("on", 1);
    instance.set("speed", -1);
    instance.update(1);
    EXPECT_EQ(instance.weights(), (std::vector<float>{0.25f, 0.25f, 0.5f}));
    EXPECT_EQ(instance.leading().phase, kHalf) << "rates 1, 1/2, 1/4: half a cycle back";
    instance.set("x", 3);
    instance.set("on", 0);
    instance.update(0);
    EXPECT_EQ(instance.weights(), (std::vector<float>{0, 1, 0}));
}

Controller with_events(bool loop, float speed = 1,
                       std::vector<ControllerEvent> events = {{"end", "a", 1}, {"half", "a", 0.5}, {"start", "a", 0}}) {
    Controller controller{.name = "test", .events = std::move(events)};
    controller.layers = {{.name = "base", .states = {one_clip("a", loop, speed)}}};
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
    EXPECT_EQ(instance.leading().phase, kHalf);
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

TEST(Controller, DirectLayersFollowPlayCommands) {
    Instance instance(direct_layers(2));
    instance.update(1);
    ASSERT_EQ(instance.last.active_clips.size(), 1u) << "the rest pose";
    EXPECT_EQ(instance.last.active_clips[0].clip, 3u);
    instance.play(1, 1, 0.5f, true, kQuarter);
    instance.update(1);  // nothing lies below, so no fade
    EXPECT_EQ(instance.weights(), (std::vector<float>{0, 1, 0}));
    EXPECT_EQ(instance.leading().fade, 1);
    EXPECT_EQ(instance.leading().phase, kHalf);
    EXPECT_EQ(instance.last.active_clips[0].time_s, 1);
    instance.play(3, 2);
    instance.update(0.25f);
    ASSERT_EQ(instance.last.active_clips.size(), 2u);
    EXPECT_EQ(instance.last.active_clips[0].clip, 3u);
    EXPECT_EQ(instance.last.active_clips[0].weight, 0.5f);
    instance.play(0, 0, -1, false, io::kLastPhase, 1);
    instance.update(0.25f);
    EXPECT_EQ(instance.leading(1).phase, io::kLastPhase - kQuarter);
    EXPECT_EQ(instance.last.active_clips.back().layer, 1u);
}

TEST(Controller, LayerWeightsFadeToTheirGoals) {
    Controller controller = direct_layers(2, {{"none", {}}});
    controller.parameters = {{"x", ParameterType::kFloat, 1}};
    controller.layers[0].weight_parameter = "x";
    Instance instance(controller);
    instance.play(0);
    const auto aim = [&](float goal, float fade_rate, uint32_t mode = io::kModeOverride, uint32_t mask = kNone) {
        instance.reference.apply({.kind = io::kCommandLayer,
                                  .target = 0,
                                  .motion = mask,
                                  .phase = mode,
                                  .value = goal,
                                  .fade_rate = fade_rate});
    };
    const auto expect = [&](float time_step_s, float weight) {
        instance.update(time_step_s);
        if (weight > 0) {
            EXPECT_EQ(instance.last.active_clips.back().layer_weight, weight);
        } else {
            EXPECT_EQ(instance.last.active_clips.back().layer, kNone);
        }
        EXPECT_EQ(instance.last.active_clips.size(), weight > 0 && weight < 1 ? 2u : 1u)
            << "the rest pose where it does not cover all";
    };
    expect(1, 1);
    aim(0.5f, 2);
    expect(0.25f, 0.75f);
    expect(0, 0.75f);
    expect(-1, 0.75f);
    expect(1, 0.5f);
    instance.set("x", 0.5f);
    expect(1, 0.25f);
    instance.set("x", -1);
    expect(1, 0);
    instance.set("x", 7);
    expect(1, 1);
    aim(0, 0);
    expect(0, 0);
    EXPECT_EQ(instance.leading().phase, kQuarter) << "time goes on unseen: 5.25 s so far";
    aim(1, 0, io::kModeAdditive);
    instance.update(0);
    EXPECT_EQ(instance.last.active_clips.size(), 2u) << "an additive layer needs something below";
    aim(1, 0, io::kModeOverride, 0);
    instance.update(0);
    EXPECT_EQ(instance.last.active_clips.size(), 2u) << "so does a masked one";
}

// Clip a walks 2 m along z in a cycle of 1 s; b makes a quarter turn on the spot in 2 s; c stands still.
TEST(Controller, RootMotionComesFromTheLowestLayer) {
    Character character = character_of({1, 2, 4});
    character.root_rows = {{0, 0, 1, 0}, {0, 1, 1, 0}, {0, 2, 1, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}};
    character.clips[0].root_row_count = 3;
    character.clips[1].first_root_row = 3;
    character.clips[1].root_row_count = 2;
    const Controller controller = direct_layers(2);
    ControllerReference reference(controller, character);
    const auto play = [&](uint32_t layer, uint32_t clip, float fade_rate = 0) {
        reference.apply(
            {.kind = io::kCommandPlay, .target = layer, .motion = clip, .loop = 1, .value = 1, .fade_rate = fade_rate});
    };
    const auto expect = [&](float time_step_s, double x, double z, double turn_rad) {
        const GroundMove move = reference.update(time_step_s).move;
        EXPECT_NEAR(move.x, x, 1e-6);
        EXPECT_NEAR(move.z, z, 1e-6);
        EXPECT_NEAR(std::atan2(move.sin, move.cos), turn_rad, 1e-6);
    };
    expect(1, 0, 0, 0);
    play(0, 0);
    play(1, 1);
    expect(0.75f, 0, 1.5, 0);
    expect(3.5f, 0, 7, 0);
    expect(-0.5f, 0, -1, 0);
    play(0, 2, 1);
    expect(0.5f, 0, 0.5, 0);  // weights a half each
    play(0, 1);
    expect(4, 0, 0, std::acos(-1));
    play(0, 2, 0.5f);
    expect(1, 0, 0, std::acos(-1) / 8);  // half of half a cycle
    reference.apply({.kind = io::kCommandLayer, .target = 0, .motion = kNone, .value = 0});
    expect(1, 0, 0, 0);
}

TEST(Controller, ActiveClipsHaveTheFormatOfTheStages) {
    Controller controller = direct_layers(2, {{"none", {}}, {"some", {}}});
    controller.layers[1].mode = LayerMode::kAdditive;
    controller.layers[1].mask = "some";
    Instance instance(controller, {1, 2, 3});  // with the durations that the tables were made for
    instance.play(0);
    instance.play(2, 1);
    instance.play(1, 0, 1, true, 0, 1);
    instance.update(0.75f);
    const std::vector<io::ActiveClip> active_clips = to_io(instance.last.active_clips, instance.character);
    ASSERT_EQ(active_clips.size(), 3u);
    EXPECT_EQ(active_clips[0].flags, io::kActiveClipBeginsLayer);
    EXPECT_EQ(active_clips[1].flags, io::kActiveClipEndsLayer);
    EXPECT_EQ(active_clips[2].flags, io::kActiveClipBeginsLayer | io::kActiveClipEndsLayer | io::kActiveClipEnds |
                                         io::kActiveClipAdditive | io::kActiveClipMasked |
                                         1u << io::kActiveClipMaskShift);
    for (size_t i = 0; i < 3; ++i) {
        const Clip& clip = instance.character.clips[instance.last.active_clips[i].clip];
        const RowCursor rows = find_rows_reference(
            std::span(instance.character.times_s).subspan(clip.first_time, clip.row_count), 0.75);
        EXPECT_EQ(active_clips[i].first_track, instance.last.active_clips[i].clip * 4);
        EXPECT_EQ(active_clips[i].earlier, clip.first_row + rows.earlier * clip.row_stride);
        EXPECT_EQ(active_clips[i].later, clip.first_row + rows.later * clip.row_stride);
        EXPECT_NEAR(active_clips[i].fraction, rows.fraction, 1e-5);
        EXPECT_EQ(active_clips[i].reference_row, clip.first_row);
    }
}

}  // namespace
}  // namespace throng
