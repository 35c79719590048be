#include "tools/controller/controller_text.h"

#include <algorithm>
#include <charconv>
#include <map>
#include <set>

namespace throng::tools {

std::string number_text(float value) {
    char digits[32];
    return {digits, std::to_chars(digits, digits + sizeof(digits), value).ptr};
}

std::string motion_text(const ControllerState& state) {
    if (state.points.empty()) return "nothing";
    if (state.x_parameter.empty()) return state.points[0].clip;
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

std::string play_text(const ControllerState& state) {
    std::string text = state.loop ? "" : "once";
    if (const std::string speed = factor_text(state.speed, state.speed_parameter); speed != "1")
        text += (text.empty() ? "speed " : ", speed ") + speed;
    return text;
}

std::string factor_text(float number, const std::string& parameter) {
    if (parameter.empty()) return number_text(number);
    return number == 1 ? parameter : number_text(number) + " * " + parameter;
}

namespace {

// A transition with an `exit` waits until its state has played that far. If the state stands still, the transition is
// never taken, which looks like a bug of the game. `reason_of` says why a state stands still; empty if it does not.
template <class ReasonOf>
void warn_of_exits(std::vector<std::string>& warnings, const Controller& controller, const ReasonOf& reason_of) {
    for (const ControllerLayer& layer : controller.layers)
        for (const ControllerTransition& transition : layer.transitions)
            for (const ControllerState& state : layer.states)
                if (transition.exit > 0 && transition.from == state.name)
                    if (const std::string reason = reason_of(state); !reason.empty())
                        warnings.push_back(controller.name + ": layer '" + layer.name + "': the transition from '" +
                                           state.name + "' to '" + transition.to +
                                           "' waits for its 'exit' for ever: " + reason);
}

}  // namespace

std::vector<std::string> controller_warnings(const Controller& controller) {
    std::vector<std::string> warnings;
    warn_of_exits(warnings, controller, [](const ControllerState& state) {
        return std::string(state.speed == 0 ? "the state's speed is 0" : "");
    });
    for (const ControllerLayer& layer : controller.layers) {
        if (layer.states.empty()) continue;
        for (const ControllerTransition& transition : layer.transitions)
            if (transition.fade == FadeKind::kInertial && transition.fade_s == 0)
                warnings.push_back(controller.name + ": layer '" + layer.name + "': the inertial fade to '" +
                                   transition.to + "' has no 'fade_s', so the pose jumps");
        std::multimap<std::string_view, std::string_view> next;  // transitions from "" can be taken in any state
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

std::vector<std::string> controller_warnings(const Controller& controller, const Character& character) {
    std::vector<std::string> warnings;
    std::map<std::string_view, std::vector<const Clip*>> clips;
    for (const Clip& clip : character.clips) clips[clip.name].push_back(&clip);
    std::set<std::string_view> played;
    for (const ControllerLayer& layer : controller.layers)
        for (const ControllerState& state : layer.states)
            for (const BlendPoint& point : state.points) played.insert(point.clip);
    for (const std::string_view name : played)
        if (clips[name].size() > 1)
            warnings.push_back(controller.name + " with " + character.name + ": " + std::to_string(clips[name].size()) +
                               " clips have the name '" + std::string(name) + "'; the first of them is played");
    warn_of_exits(warnings, controller, [&](const ControllerState& state) {
        const bool has_length = std::ranges::any_of(state.points, [&](const BlendPoint& point) {
            const std::vector<const Clip*>& named = clips[point.clip];
            return named.empty() || named.front()->duration_s > 0;
        });
        return std::string(has_length ? "" : "the state's clip in " + character.name + " has no length");
    });
    return warnings;
}

}  // namespace throng::tools
