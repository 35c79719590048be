// check_controller(): controllers made in code, and whether they can drive a character.
#include "tools/creatures/creature.h"

#include <throng/controller.h>

#include <gtest/gtest.h>

#include <limits>
#include <string>

namespace throng {
namespace {

Character creature() {
    return *compile_character(*make_creature({.joint_count = 40, .level_count = 12, .face_count = 100}), {.error = 0});
}

Controller two_states() {
    Controller controller;
    controller.name = "made";
    controller.events = {{"step", "walk", 1.2f}};
    controller.masks = {{"tail", {{.joint = "tail_0_0"}}}};
    controller.layers = {{.name = "body",
                          .states = {{.name = "a", .points = {{"idle"}}}, {.name = "b", .points = {{"walk"}}}},
                          .transitions = {{.from = "a", .to = "b"}}}};
    return controller;
}

std::string error_of(const Controller& controller) {
    static const Character character = creature();
    const Result<void> fits = check_controller(controller, character);
    EXPECT_TRUE(fits || fits.error().code == ErrorCode::kInvalidArgument || fits.error().code == ErrorCode::kLimit);
    return fits ? "" : fits.error().text();
}

TEST(CheckController, AcceptsWhatTheCharacterHas) {
    EXPECT_EQ(error_of(two_states()), "");
    EXPECT_EQ(error_of(direct_layers(1)), "");
    EXPECT_EQ(error_of(direct_layers(16, {{"tail", {{.joint = "tail_0_0"}}}})), "");
    for (const char* name : {"walker", "flyer", "dragon"}) {
        const Result<Controller> example = load_controller(THRONG_SOURCE_DIR "/examples/controllers/" +
                                                           std::string(name) + ".json");
        ASSERT_TRUE(example) << example.error().text();
        EXPECT_EQ(error_of(*example), "");
    }
}

TEST(CheckController, NamesWhatIsMissingAndWhatExists) {
    const auto after = [](auto change) {
        Controller controller = two_states();
        change(controller);
        return error_of(controller);
    };
    const std::string start = "made with creature: ";
    EXPECT_EQ(after([](Controller& c) { c.layers[0].states[1].points[0].clip = "Wlk"; }),
              start +
                  "layers[0].states.b.clip: there is no clip 'Wlk'; did you mean 'walk'? There are: idle, walk, fly, "
                  "glide, roar");
    EXPECT_EQ(after([](Controller& c) { c.events[0].clip = "swim"; }),
              start + "events[0].clip: there is no clip 'swim'. There are: idle, walk, fly, glide, roar");
    EXPECT_EQ(after([](Controller& c) { c.events[0].time_s = 1.3; }),
              start + "events[0].at_s: 1.3 s is beyond the end of clip 'walk', which lasts 1.2 s");
    const std::string joint = after([](Controller& c) { c.masks[0].items[0].joint = "tail_0"; });
    EXPECT_TRUE(joint.starts_with(
        start +
        "masks.tail[0].joint: there is no joint 'tail_0'; did you mean 'tail_0_0'? There are: body, tail_0_0, "))
        << joint;
    EXPECT_TRUE(joint.ends_with(", … (40 in all)")) << joint;
}

TEST(CheckController, KeepsTheRulesOfFiles) {
    const auto after = [](auto change) {
        Controller controller = two_states();
        change(controller);
        return error_of(controller);
    };
    const std::string start = "made with creature: ";
    const float nan = std::numeric_limits<float>::quiet_NaN();
    EXPECT_EQ(error_of(Controller{.name = "made"}), start + "layers: a controller needs at least one layer");
    EXPECT_EQ(after([](Controller& c) { c.layers.push_back(c.layers[0]); }),
              start + "layers[1].name: the name 'body' is taken; rename one");
    EXPECT_EQ(after([](Controller& c) { c.layers[0].states[1].name = "a"; }),
              start + "layers[0].states.a: the name 'a' is taken; rename one");
    EXPECT_EQ(after([](Controller& c) {
                  c.layers[0].states[1].points.clear();
                  c.layers[0].states[1].x_parameter = "speed";
              }),
              start + "layers[0].states.b.clips: a blend needs at least one clip");
    EXPECT_EQ(
        after([](Controller& c) { c.layers[0].states[1].points.push_back({"fly"}); }),
        start + "layers[0].states.b.blend: a state of several clips needs the parameter that chooses between them");
    EXPECT_EQ(after([&](Controller& c) { c.layers[0].states[1].speed = nan; }),
              start + "layers[0].states.b.speed: must be a finite number");
    EXPECT_EQ(after([&](Controller& c) { c.layers[0].transitions[0].fade_s = nan; }),
              start + "layers[0].transitions[0].fade_s: nan is not between 0.0001 and 1000");
    EXPECT_EQ(after([&](Controller& c) { c.masks[0].items[0].weight = nan; }),
              start + "masks.tail[0].weight: nan is not between 0 and 1");
    EXPECT_EQ(after([](Controller& c) {
                  c.parameters = {{"p", ParameterType::kBool, 2}};
              }),
              start + "parameters.p: the initial value must be 0 or 1");
    EXPECT_EQ(after([](Controller& c) {
                  c.parameters = {{"p", static_cast<ParameterType>(9)}};
              }),
              start + "parameters.p: its type is none of ParameterType");
    EXPECT_EQ(after([](Controller& c) { c.layers[0].mode = static_cast<LayerMode>(-1); }),
              start + "layers[0].mode: is neither of LayerMode");
    EXPECT_EQ(after([](Controller& c) {
                  c.parameters.push_back({"p"});
                  c.layers[0].transitions[0].conditions = {{"p", static_cast<ControllerCondition::Test>(5)}};
              }),
              start + "layers[0].transitions[0].when.p: its test is none of ControllerCondition::Test");
    EXPECT_EQ(after([](Controller& c) { c.layers[0].transitions[0].fade = static_cast<FadeKind>(2); }),
              start + "layers[0].transitions[0].fade: is neither of FadeKind");
    EXPECT_EQ(after([](Controller& c) { c.layers.resize(17, {.name = "x"}); }),
              start + "layers: 17 layers, more than the limit of 16");
}

// Each state gets its own list of these transitions, so a few megabytes of JSON could take gigabytes.
TEST(CheckController, TransitionsFromAnyStateCountForEachState) {
    ControllerLayer layer;
    for (int i = 0; i < 1024; ++i) layer.states.push_back({.name = "s" + std::to_string(i), .points = {{"idle"}}});
    layer.transitions.resize(256, {.to = "s0", .exit = 1});
    Controller controller{.name = "made"};
    for (const char* name : {"a", "b", "c", "d"}) {
        controller.layers.push_back(layer);
        controller.layers.back().name = name;
    }
    EXPECT_EQ(error_of(controller), "");
    controller.layers[1].transitions.push_back({.from = "s1", .to = "s2"});
    EXPECT_EQ(error_of(controller),
              "made with creature: layers: 1048577 transitions, more than the limit of 1048576: one without 'from' "
              "counts once for each state of its layer; give some a 'from'");
}

TEST(CheckController, DirectLayersHaveNoStates) {
    const Controller direct = direct_layers(3, {{"tail", {}}});
    ASSERT_EQ(direct.layers.size(), 3u);
    EXPECT_EQ(direct.masks.size(), 1u);
    for (uint32_t i = 0; i < 3; ++i) {
        EXPECT_TRUE(direct.layers[i].states.empty());
        EXPECT_EQ(direct.layers[i].weight, 1);
        EXPECT_EQ(direct.find_layer(direct.layers[i].name), i);
    }
}

}  // namespace
}  // namespace throng
