// The director: the parameter values that it chooses for characters with controllers.
#include "tools/scene/director.h"

#include <gtest/gtest.h>

namespace throng::tools {
namespace {

TEST(Director, ParameterRangesCoverTheControllersConditions) {
    const Result<Controller> controller = parse_controller(
        R"({
      "parameters": {"speed": 0, "side": 0, "brave": false, "jump": "trigger", "weight": 1, "height": 0, "depth": 5},
      "layers": [{"name": "body", "weight": "weight", "states": {
        "stand": {"clip": "idle"},
        "climb": {"blend": "height", "clips": [{"clip": "a", "at": 2}, {"clip": "b", "at": 6}]},
        "move": {"blend": ["side", "speed"], "clips": [{"clip": "a", "at": [0, 0]}, {"clip": "b", "at": [-2, 0]}, )"
        R"({"clip": "c", "at": [0, 4]}]}},
        "transitions": [{"from": "stand", "to": "move", "when": {"speed": {"above": 8}}}, {"from": "move", "to": )"
        R"("stand", "when": {"side": {"below": -3}, "brave": true, "jump": "triggered", "depth": {"below": 4}}}]}]})",
        "test.json");
    ASSERT_TRUE(controller) << controller.error().text();
    const auto range = [&](const char* name) { return parameter_range(*controller, controller->find_parameter(name)); };
    EXPECT_EQ(range("speed").least, 0);
    EXPECT_EQ(range("speed").most, 10);  // values above 8 must occur
    EXPECT_EQ(range("side").least, -3.75f);
    EXPECT_EQ(range("side").most, 0);
    EXPECT_EQ(range("height").least, 2);
    EXPECT_EQ(range("height").most, 6);
    EXPECT_EQ(range("depth").least, 3);
    EXPECT_EQ(range("depth").most, 5);
    EXPECT_EQ(range("weight").least, 0);
    EXPECT_EQ(range("weight").most, 1);
    EXPECT_EQ(range("brave").type, ParameterType::kBool);
    EXPECT_EQ(range("brave").most, 1);
    EXPECT_EQ(range("jump").type, ParameterType::kTrigger);
}

}  // namespace
}  // namespace throng::tools
