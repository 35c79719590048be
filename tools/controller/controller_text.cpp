#include "tools/controller/controller_text.h"

#include <charconv>
#include <map>
#include <set>

namespace throng::tools {

std::string number_text(float value) {
    char digits[32];
    return {digits, std::to_chars(digits, digits + sizeof(digits), value).ptr};
}

std::string motion_text(const ControllerState& state) {
    if (state.x_parameter.empty()) return state.points.at(0).clip;
    const bool of_two = !state.y_parameter.empty();
    std::string text;
    for (const BlendPoint& point : state.points) {
        text += (text.empty() ? "" : ", ") + point.clip + " at ";
        text += of_two ? "(" + number_text(point.x) + ", " + number_text(point.y) + ")" : number_text(point.x);
    }
    return text + " by " + state.x_parameter + (of_two ? " and " + state.y_parameter : "");
}

std::string conditions_text(const ControllerTransition& transition) {
    using Test = ControllerCondition::Test;
    std::string text;
    for (const auto& [parameter, test, value] : transition.conditions) {
        text += text.empty() ? "" : ", ";
        switch (test) {
            case Test::kAbove: text += parameter + " > " + number_text(value); break;
            case Test::kBelow: text += parameter + " < " + number_text(value); break;
            case Test::kIsTrue: text += parameter; break;
            case Test::kIsFalse: text += "not " + parameter; break;
            case Test::kTriggered: text += parameter + " triggered"; break;
        }
    }
    return text;
}

std::vector<std::string> timing_text(const ControllerTransition& transition) {
    std::vector<std::string> text;
    if (transition.exit > 0)
        text.push_back("after " + number_text(transition.exit) + (transition.exit == 1 ? " cycle" : " cycles"));
    if (transition.fade_s > 0)
        text.push_back(number_text(transition.fade_s) + " s" +
                       (transition.fade == FadeKind::kInertial ? " inertial" : ""));
    if (transition.interrupts) text.push_back("interrupts");
    return text;
}

std::string factor_text(float number, const std::string& parameter) {
    if (parameter.empty()) return number_text(number);
    return number == 1 ? parameter : number_text(number) + " * " + parameter;
}

std::vector<std::string> controller_warnings(const Controller& controller) {
    std::vector<std::string> warnings;
    for (const ControllerLayer& layer : controller.layers) {
        if (layer.states.empty()) continue;
        std::multimap<std::string_view, std::string_view> next;  // what leads away from "" can be taken in any state
        for (const ControllerTransition& transition : layer.transitions) next.emplace(transition.from, transition.to);
        std::set<std::string_view> reached;
        std::vector<std::string_view> open{layer.states[0].name, ""};
        while (!open.empty()) {
            const std::string_view state = open.back();
            open.pop_back();
            if (!reached.insert(state).second) continue;
            for (auto [to, end] = next.equal_range(state); to != end; ++to) open.push_back(to->second);
        }
        for (const ControllerState& state : layer.states)
            if (!reached.contains(state.name))
                warnings.push_back(controller.name + ": layer '" + layer.name + "': no transitions lead to state '" +
                                   state.name + "'");
    }
    return warnings;
}

}  // namespace throng::tools
