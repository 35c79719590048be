// The rules of docs/controller.md, one at a time, with one instance and results worked out by hand.
#include "tests/host/controller_states.h"

#include <gtest/gtest.h>

#include <limits>

namespace throng {
namespace {

using namespace test;
using When = ControllerCondition::Test;

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
    EXPECT_EQ(instance.leading().phase, kQuarterCycle / 2) << "what begins has all of the step: 0.25 of 2 s";
    EXPECT_EQ(instance.reference.layers[0].plays[1].phase, kQuarterCycle + kQuarterCycle / 2)
        << "what fades out goes on";
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
        EXPECT_EQ(instance.leading().phase, io::kLastPhase - kQuarterCycle) << loop;
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
         .states = {clip_state("b"), clip_state("c")},
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
    EXPECT_EQ(looping.leading().phase, kHalfCycle);
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
    put_into(1, kHalfCycle, 2);  // before the state has begun
    instance.update(0);
    EXPECT_EQ(instance.leading().motion, 1u);
    EXPECT_EQ(instance.leading().phase, kHalfCycle);
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
    EXPECT_EQ(any.leading().phase, kHalfCycle);
    EXPECT_EQ(any.reference.parameters[0], 1) << "not asked for, not reset";
    EXPECT_EQ(named.leading().phase, kQuarterCycle);
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
    EXPECT_EQ(instance.leading().phase, kQuarterCycle / 2);
    EXPECT_EQ(instance.leading().loops, 1u) << "since it was entered";
    EXPECT_EQ(instance.reference.layers[0].plays[1].phase, kQuarterCycle / 2);
    EXPECT_EQ(instance.reference.layers[0].plays[1].loops, 1u);
    instance.update(0.5f);  // b alone, 0.25 of a cycle
    EXPECT_EQ(instance.leading().phase, kQuarterCycle / 2 + kQuarterCycle);
}

TEST(Controller, PlaysOutOfSyncKeepTheirOwnTime) {
    Instance instance(synchronised());
    instance.update(0);
    instance.set("go", 1);
    instance.update(1);  // b alone
    instance.set("x", 1);
    instance.update(0.5f);  // c fades in
    EXPECT_EQ(instance.leading().phase, kQuarterCycle / 2) << "c keeps its own time";
    const uint32_t phase_of_b = instance.reference.layers[0].plays[1].phase;
    EXPECT_EQ(phase_of_b, kHalfCycle + kQuarterCycle);
    instance.set("on", 1);
    instance.update(0.5f);  // a fades in over c (at weight 1) and b (dropped), so there is no phase to take over
    EXPECT_EQ(instance.leading().phase, phase_of_b + static_cast<uint32_t>(0.5 * 0x1p32))
        << "b was still there when a was pushed; a then goes at its own rate of 1";
    EXPECT_EQ(instance.play_count(), 2u);
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
    EXPECT_EQ(instance.leading().phase, kHalfCycle) << "rates 1, 1/2, 1/4: half a cycle back";
    instance.set("x", 3);
    instance.set("on", 0);
    instance.update(0);
    EXPECT_EQ(instance.weights(), (std::vector<float>{0, 1, 0}));
}

}  // namespace
}  // namespace throng
