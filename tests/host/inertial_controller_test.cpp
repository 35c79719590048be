// Inertial plays and transitions: only the new clip plays, and the offset from the old pose dies away
// (docs/controller.md, step 10).
#include "tests/controller_instance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace throng::test {
namespace {

void play_inertially(Instance& instance, uint32_t clip, float fade_s, uint32_t layer = 0) {
    instance.reference.apply({.kind = io::kCommandPlayInertial,
                              .target = layer,
                              .motion = clip,
                              .loop = 1,
                              .value = 1,
                              .fade_rate = fade_s > 0 ? 1 / fade_s : 0});
}

TEST(InertialController, OnlyTheNewClipPlays) {
    Instance instance(direct_layers(1, {}, true));
    instance.play(0);
    instance.update(0.5f);
    EXPECT_EQ(instance.last.inertial_s, 0);
    play_inertially(instance, 1, 4);
    instance.update(0.5f);
    EXPECT_EQ(instance.weights(), (std::vector<float>{0, 1, 0}));
    EXPECT_EQ(instance.play_count(), 1u);
    EXPECT_EQ(instance.last.inertial_s, 4);
    instance.update(0.5f);
    EXPECT_EQ(instance.last.inertial_s, 0) << "it begins once";
    play_inertially(instance, 2, 0);
    instance.update(0.5f);
    EXPECT_EQ(instance.weights(), (std::vector<float>{0, 0, 1}));
    EXPECT_EQ(instance.last.inertial_s, 0) << "a fade that takes no time";
}

// The angle between two rotation matrices without scale.
double angle_between(const AffineT<double>& a, const AffineT<double>& b) {
    double trace = 0;
    for (size_t row = 0; row < 3; ++row)
        for (size_t column = 0; column < 3; ++column) trace += a.row[row][column] * b.row[row][column];
    return std::acos(std::clamp((trace - 1) / 2, -1.0, 1.0));
}

// Between clips that stand still, so that the offset has no speed: the quintic is then 1 - s^3 (10 - 15 s + 6 s^2).
TEST(InertialController, TheOffsetToThePreviousPoseDecays) {
    const Character character = make_character({.joint_count = 4, .scale_spread = 0});
    const Controller controller = direct_layers(1, {}, true);
    const ClipPlayback first{.clip = 0, .time_s = 0.25, .speed = 0}, second{.clip = 1, .time_s = 1.25, .speed = 0};
    const auto root_of = [&](const ClipPlayback& clip) {
        return reference_pose(character, {.first = clip})->model_from_joint[0];
    };
    const double whole_rad = angle_between(root_of(first), root_of(second));
    ASSERT_GT(whole_rad, 0.5);
    ReferenceCharacter one = std::move(*ReferenceCharacter::create(character, controller));
    ASSERT_TRUE(one.play(0, {.clip = first}) && one.update(0.0625f) && one.update(0.0625f));
    ASSERT_TRUE(one.play(0, {.clip = second, .fade_s = 0.5f, .fade = FadeKind::kInertial}));
    for (int step = 1; step <= 10; ++step) {
        ASSERT_TRUE(one.update(0.0625f));
        const double s = std::min(step / 8.0, 1.0), left = 1 - s * s * s * (10 - 15 * s + 6 * s * s);
        const AffineT<double> root = one.pose().model_from_joint[0];
        EXPECT_NEAR(angle_between(root, root_of(second)), left * whole_rad, 1e-6) << step;
        EXPECT_NEAR(angle_between(root, root_of(first)), (1 - left) * whole_rad, 1e-6) << step;
        ASSERT_EQ(one.layers()[0].size(), 1u);
        EXPECT_EQ(one.layers()[0][0].motion, 1u);
    }
}

// ---- Several layers begin in one update

ControllerLayer going_layer(const std::string& name, FadeKind fade, float fade_s) {
    return {.name = name,
            .states = {{.name = "a", .points = {{"a"}}}, {.name = "b", .points = {{"b"}}}},
            .transitions = {{.from = "a",
                             .to = "b",
                             .conditions = {{"go", ControllerCondition::Test::kTriggered}},
                             .fade_s = fade_s,
                             .fade = fade}}};
}

// The inertial time after the trigger fires the layers' transitions, and after plays on layers without states.
float begun_by(std::vector<ControllerLayer> layers, const std::vector<std::pair<uint32_t, float>>& plays = {}) {
    Instance instance({.name = "test", .parameters = {{"go", ParameterType::kTrigger}}, .layers = std::move(layers)});
    instance.update(0.125f);
    EXPECT_EQ(instance.last.inertial_s, 0);
    instance.set("go", 1);
    for (const auto& [layer, fade_s] : plays) play_inertially(instance, 2, fade_s, layer);
    instance.update(0.125f);
    const float begun_s = instance.last.inertial_s;
    instance.update(0.125f);
    EXPECT_EQ(instance.last.inertial_s, 0) << "it begins once";
    return begun_s;
}

TEST(InertialController, OfSeveralTransitionsTheHighestLayersIsUsed) {
    const auto going = [](const char* name, float fade_s) { return going_layer(name, FadeKind::kInertial, fade_s); };
    const auto told = [](const char* name) { return ControllerLayer{.name = name, .inertial_plays = true}; };
    EXPECT_EQ(begun_by({going("low", 0.5f), going("high", 2)}), 2);
    EXPECT_EQ(begun_by({going("low", 2), going("high", 0.5f)}), 0.5f);
    EXPECT_EQ(begun_by({going("low", 2), going_layer("high", FadeKind::kCross, 0.5f)}), 2) << "of those that have one";
    EXPECT_EQ(begun_by({going("low", 2), going("high", 0)}), 2) << "of those that take time";
    EXPECT_EQ(begun_by({told("low"), told("high")}, {{0, 0.5f}, {1, 2}}), 2);
    EXPECT_EQ(begun_by({told("low"), told("high")}, {{1, 0.5f}, {0, 2}}), 0.5f) << "whichever was told first";
    EXPECT_EQ(begun_by({going("low", 0.5f), told("high")}, {{1, 2}}), 2);
    EXPECT_EQ(begun_by({told("low"), going("high", 0.5f)}, {{0, 2}}), 0.5f);
}

}  // namespace
}  // namespace throng::test
