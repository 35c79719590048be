// Small controllers for tests of the rules of docs/controller.md.
#pragma once

#include "tests/controller_instance.h"

#include <string>
#include <utility>
#include <vector>

namespace throng::test {

inline constexpr uint32_t kHalfCycle = 0x80000000u, kQuarterCycle = 0x40000000u;

inline ControllerState clip_state(std::string name, bool loop = true, float speed = 1) {
    return {.name = name, .points = {{name}}, .loop = loop, .speed = speed};
}

// States a, b, c, each with the clip of the same name.
inline Controller three_states(std::vector<ControllerTransition> transitions, bool loop = true) {
    Controller controller{.name = "test",
                          .parameters = {{"go", ParameterType::kTrigger}, {"x"}, {"on", ParameterType::kBool}}};
    controller.layers = {{.name = "base",
                          .states = {clip_state("a", loop), clip_state("b", loop), clip_state("c", loop)},
                          .transitions = std::move(transitions)}};
    return controller;
}
inline const std::vector<ControllerCondition> kGo{{"go", ControllerCondition::Test::kTriggered}};

}  // namespace throng::test
