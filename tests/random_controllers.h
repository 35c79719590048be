// Random controllers made from a seed.
#pragma once

#include "tests/test_rig.h"

namespace throng::test {

// Times, rates and speeds whose products are exact, so that the result does not depend on how time is divided into
// steps.
struct Exact {
    Controller controller;
    std::vector<float> durations_s;
};
inline Exact random_controller(Random& random) {
    Exact exact{.durations_s = {0.5f, 1, 2, 4}};
    exact.controller = {.name = "random", .parameters = {{"x"}, {"y"}}};
    for (int i = 0; i < 12; ++i) {
        const uint32_t clip = random.below(4);
        const double place = random.chance(0.3) ? random.below(9) / 8.0 : random.unit();
        exact.controller.events.push_back({"event " + std::to_string(i), std::string(1, static_cast<char>('a' + clip)),
                                           place * exact.durations_s[clip]});
    }
    const uint32_t layer_count = 1 + random.below(3);
    for (uint32_t layer = 0; layer < layer_count; ++layer) {
        ControllerState state{
            .name = "only", .loop = random.chance(0.7), .speed = (static_cast<float>(random.below(33)) - 16) / 8};
        const uint32_t kind = random.below(3);
        for (uint32_t i = 0; i < (kind == 0 ? 1 : 4); ++i)
            state.points.push_back({std::string(1, static_cast<char>('a' + random.below(4))),
                                    static_cast<float>(kind == 1 ? i : i % 2), static_cast<float>(i / 2)});
        if (kind > 0) state.x_parameter = "x";
        if (kind > 1) state.y_parameter = "y";
        exact.controller.layers.push_back({.name = std::to_string(layer), .states = {state}});
    }
    return exact;
}

// Three states per layer that differ only in their sync groups or in playing nothing, with transitions between them.
inline void add_random_transitions(Random& random, Controller& controller) {
    using When = ControllerCondition::Test;
    for (ControllerLayer& layer : controller.layers) {
        for (const char* name : {"second", "third"}) {
            layer.states.push_back(layer.states[0]);
            layer.states.back().name = name;
        }
        for (ControllerState& state : layer.states) {
            state.sync = random.chance(0.5) ? "feet" : "";
            if (random.chance(0.25)) state = {.name = state.name};
        }
        for (int i = 0; i < 6; ++i)
            layer.transitions.push_back(
                {.to = layer.states[random.below(3)].name,
                 .conditions = {{random.chance(0.5) ? "x" : "y", random.chance(0.5) ? When::kAbove : When::kBelow,
                                 static_cast<float>(random.unit())}},
                 .exit = random.chance(0.3) ? static_cast<float>(random.unit()) : 0,
                 .fade_s = random.chance(0.7) ? static_cast<float>(random.between(0.05, 0.5)) : 0,
                 .interrupts = random.chance(0.7)});
    }
}

}  // namespace throng::test
