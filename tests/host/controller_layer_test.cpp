// Layers of controllers; as controller_test.cpp.
#include "control/control_reference.h"
#include "control/layer_commands.h"
#include "tests/host/controller_states.h"

#include <gtest/gtest.h>

namespace throng {
namespace {

using namespace test;

// A body that plays "a", and a layer above it that rests, or plays "b" (2 s, with an event at its beginning).
Controller body_and_gesture() {
    Controller controller = three_states({});
    controller.layers.push_back(
        {.name = "gesture",
         .weight = 0.5f,
         .states = {{.name = "rest"}, clip_state("b", false)},
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

TEST(Controller, DirectLayersFollowPlayCommands) {
    Instance instance(direct_layers(2));
    instance.update(1);
    ASSERT_EQ(instance.last.active_clips.size(), 1u) << "the rest pose";
    EXPECT_EQ(instance.last.active_clips[0].clip, 3u);
    instance.play(1, 1, 0.5f, true, kQuarterCycle);
    instance.update(1);  // nothing lies below, so no fade
    EXPECT_EQ(instance.weights(), (std::vector<float>{0, 1, 0}));
    EXPECT_EQ(instance.leading().fade, 1);
    EXPECT_EQ(instance.leading().phase, kHalfCycle);
    EXPECT_EQ(instance.last.active_clips[0].time_s, 1);
    instance.play(3, 2);
    instance.update(0.25f);
    ASSERT_EQ(instance.last.active_clips.size(), 2u);
    EXPECT_EQ(instance.last.active_clips[0].clip, 3u);
    EXPECT_EQ(instance.last.active_clips[0].weight, 0.5f);
    instance.play(0, 0, -1, false, io::kLastPhase, 1);
    instance.update(0.25f);
    EXPECT_EQ(instance.leading(1).phase, io::kLastPhase - kQuarterCycle);
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
    EXPECT_EQ(instance.leading().phase, kQuarterCycle) << "time goes on unseen: 5.25 s so far";
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
