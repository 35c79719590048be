#include "controller/controller_rules.h"

#include "base/enumeration.h"
#include "base/failure.h"
#include "json/json_view.h"
#include "json/known_names.h"

#include <charconv>
#include <cmath>

namespace throng {
namespace {

std::string text(float value) {
    char digits[64];
    // 1000000, not 1e+06
    const auto format = std::abs(value) < 1e9f ? std::chars_format::fixed : std::chars_format::scientific;
    return {digits, std::to_chars(digits, digits + sizeof(digits), value, format).ptr};
}

void require_at_most(size_t limit, size_t count, const std::string& place, const char* what) {
    if (count <= limit) return;
    throw Failure(ErrorCode::kLimit, place, count, " ", what, ", more than the limit of ", limit);
}

void require_finite(float value, const std::string& place) {
    if (!std::isfinite(value)) refuse(place, "must be a finite number");
}

void require_between(float low, float high, float value, const std::string& place) {
    if (!(value >= low && value <= high))
        refuse(place, text(value), " is not between ", text(low), " and ", text(high));
}

void require_name(std::string_view name, const std::string& place) {
    if (name.empty()) refuse(place, "a name must not be empty");
    if (name.size() <= kNameLimit) return;
    throw Failure(ErrorCode::kLimit, place, "the name is longer than the limit of ", kNameLimit, " bytes");
}

// For names that the controller defines. They appear in messages.
void require_printable_name(std::string_view name, const std::string& place) {
    require_name(name, place);
    if (printable(name, kNameLimit) != name)
        refuse(place,
               "a name must not have line breaks, other control characters, characters that override the text "
               "direction, or invalid UTF-8");
}

void add_unique(KnownNames& names, std::string_view name, const std::string& place) {
    require_printable_name(name, place);
    if (!names.add(name)) refuse(place, "the name '", printable(name), "' is taken; rename one");
}

// Runs the checks, and keeps the names that later checks look up.
class Rules {
public:
    explicit Rules(const Controller& controller) : controller_(controller) {}

    void check() {
        check_parameters();
        check_masks();
        check_events();
        check_layers();
    }

private:
    void check_parameters() {
        require_at_most(kParameterLimit, controller_.parameters.size(), "parameters", "parameters");
        for (const ControllerParameter& parameter : controller_.parameters) {
            const std::string place = place_of("parameters", parameter.name);
            add_unique(parameters_, parameter.name, place);
            if (!is_known(parameter.type, ParameterType::kTrigger)) refuse(place, "its type is none of ParameterType");
            require_finite(parameter.initial, place);
            if (parameter.type != ParameterType::kFloat && parameter.initial != 0 && parameter.initial != 1)
                refuse(place, "the initial value must be 0 or 1");
        }
    }

    void check_masks() {
        require_at_most(kMaskLimit, controller_.masks.size(), "masks", "masks");
        for (const JointMask& mask : controller_.masks) {
            const std::string place = place_of("masks", mask.name);
            add_unique(masks_, mask.name, place);
            require_at_most(kMaskItemLimit, mask.items.size(), place, "items");
            for (size_t i = 0; i < mask.items.size(); ++i) {
                require_name(mask.items[i].joint, place_of(place, i, "joint"));
                require_between(0, 1, mask.items[i].weight, place_of(place, i, "weight"));
            }
        }
    }

    void check_events() const {
        require_at_most(kEventLimit, controller_.events.size(), "events", "events");
        for (size_t i = 0; i < controller_.events.size(); ++i) {
            const ControllerEvent& event = controller_.events[i];
            const std::string place = place_of("events", i);
            require_printable_name(event.name, place_of(place, "name"));
            require_name(event.clip, place_of(place, "clip"));
            if (!(event.time_s >= 0 && std::isfinite(event.time_s)))
                refuse(place_of(place, "at_s"), "must be a time in the clip, 0 or more seconds");
        }
    }

    void check_layers() const {
        if (controller_.layers.empty()) refuse("layers", "a controller needs at least one layer");
        require_at_most(kLayerLimit, controller_.layers.size(), "layers", "layers");
        KnownNames names("layer");
        for (size_t i = 0; i < controller_.layers.size(); ++i) {
            const ControllerLayer& layer = controller_.layers[i];
            const std::string place = place_of("layers", i);
            add_unique(names, layer.name, place_of(place, "name"));
            if (!is_known(layer.mode, LayerMode::kAdditive)) refuse(place_of(place, "mode"), "is neither of LayerMode");
            if (layer.model_space_rotations && layer.mode == LayerMode::kAdditive)
                refuse(place_of(place, "rotations"),
                       "an additive layer turns joints relative to their parents; only an override blends in model "
                       "space");
            if (layer.inertial_plays && !layer.states.empty())
                refuse(place_of(place, "inertial"),
                       "this is only for layers without states; in this one, each transition has its own 'fade'");
            if (!layer.mask.empty()) masks_.require(layer.mask, place_of(place, "mask"));
            if (layer.weight_parameter.empty()) require_between(0, 1, layer.weight, place_of(place, "weight"));
            check_factor(layer.weight, layer.weight_parameter, place_of(place, "weight"));
            check_states(layer, place);
        }
        check_transition_count();
    }

    // Each state gets its own list of transitions (controller_arrays.cpp).
    void check_transition_count() const {
        uint64_t count = 0;
        for (const ControllerLayer& layer : controller_.layers)
            for (const ControllerTransition& transition : layer.transitions)
                count += transition.from.empty() ? layer.states.size() : 1;
        if (count <= kAllTransitionsLimit) return;
        throw Failure(ErrorCode::kLimit, "layers", count, " transitions, more than the limit of ", kAllTransitionsLimit,
                      ": one without 'from' counts once for each state of its layer; give some a 'from'");
    }

    void check_states(const ControllerLayer& layer, const std::string& place) const {
        require_at_most(kStateLimit, layer.states.size(), place_of(place, "states"), "states");
        require_at_most(kTransitionLimit, layer.transitions.size(), place_of(place, "transitions"), "transitions");
        KnownNames states("state");
        for (const ControllerState& state : layer.states) {
            const std::string state_place = place_of(place, "states", state.name);
            add_unique(states, state.name, state_place);
            if (state.name == "*") refuse(state_place, "'*' means any state; choose another name");
            check_factor(state.speed, state.speed_parameter, place_of(state_place, "speed"));
            check_points(state, state_place);
        }
        if (layer.states.empty() && !layer.transitions.empty())
            refuse(place_of(place, "transitions"), "the layer has no states to go between; give it 'states'");
        for (size_t i = 0; i < layer.transitions.size(); ++i)
            check_transition(layer, layer.transitions[i], states, place_of(place, "transitions", i));
    }

    // A parameter that a number is multiplied by must be a float or a bool.
    void check_number(const std::string& parameter, const std::string& place) const {
        const uint32_t index = parameters_.require(parameter, place);
        if (controller_.parameters[index].type == ParameterType::kTrigger)
            refuse(place, "'", printable(parameter), "' is a trigger, not a number; use a float or a bool");
    }
    void check_factor(float value, const std::string& parameter, const std::string& place) const {
        require_finite(value, place);
        if (!parameter.empty()) check_number(parameter, place_of(place, "parameter"));
    }

    void check_points(const ControllerState& state, const std::string& place) const {
        const std::string clips = place_of(place, "clips"), blend = place_of(place, "blend");
        const bool of_two = !state.y_parameter.empty();
        require_at_most(kBlendPointLimit, state.points.size(), clips, "clips");
        if (state.points.empty()) return check_empty(state, place);
        if (state.x_parameter.empty() && (of_two || state.points.size() > 1))
            refuse(blend, "a state of several clips needs the parameter that chooses between them");
        if (!state.x_parameter.empty()) check_number(state.x_parameter, of_two ? place_of(blend, 0) : blend);
        if (of_two) check_number(state.y_parameter, place_of(blend, 1));
        for (size_t i = 0; i < state.points.size(); ++i) {
            const BlendPoint& point = state.points[i];
            require_name(point.clip, state.x_parameter.empty() ? place_of(place, "clip") : place_of(clips, i, "clip"));
            if (!state.x_parameter.empty()) check_distances(state, i, place_of(clips, i, "at"));
        }
    }

    // loop, speed and sync mean nothing for a state that plays nothing, so they must have their defaults.
    static void check_empty(const ControllerState& state, const std::string& place) {
        if (!state.x_parameter.empty() || !state.y_parameter.empty())
            refuse(place_of(place, "clips"), "a blend needs at least one clip");
        if (!state.loop || state.speed != 1 || !state.speed_parameter.empty() || !state.sync.empty())
            refuse(place, "plays nothing, so it must not have 'loop', 'speed' or 'sync'");
    }

    static void check_distances(const ControllerState& state, size_t i, const std::string& place) {
        const BlendPoint& point = state.points[i];
        require_between(-kBlendPlaceLimit, kBlendPlaceLimit, point.x, place);
        require_between(-kBlendPlaceLimit, kBlendPlaceLimit, point.y, place);
        if (state.y_parameter.empty()) {
            if (i > 0 && !(point.x - state.points[i - 1].x >= kMinBlendDistance))
                refuse(place, text(point.x), " is not above the ", text(state.points[i - 1].x),
                       " of the clip before; sort them, and keep them 0.000001 apart");
            return;
        }
        for (size_t k = 0; k < i; ++k)
            if (std::hypot(point.x - state.points[k].x, point.y - state.points[k].y) < kMinBlendDistance)
                refuse(place, "clips[", k, "] is at the same place; keep them 0.000001 apart");
    }

    void check_transition(const ControllerLayer& layer, const ControllerTransition& transition,
                          const KnownNames& states, const std::string& place) const {
        const std::string exit = place_of(place, "exit"), fade = place_of(place, "fade_s");
        const uint32_t from = transition.from.empty() ? kNone
                                                      : states.require(transition.from, place_of(place, "from"));
        const uint32_t to = states.require(transition.to, place_of(place, "to"));
        require_between(0, kExitLimit, transition.exit, exit);
        if (!is_known(transition.fade, FadeKind::kInertial)) refuse(place_of(place, "fade"), "is neither of FadeKind");
        if (transition.fade_s != 0) require_between(kMinFade_s, kMaxFade_s, transition.fade_s, fade);
        if (from != kNone && layer.states[from].points.empty() && transition.exit > 0)
            refuse(exit, "is never reached: state '", printable(transition.from),
                   "' plays nothing, so it counts no cycles; use 'when'");
        if (from != kNone && !layer.states[from].loop && transition.exit > 1)
            refuse(exit, "is never reached: state '", printable(transition.from),
                   "' does not loop, so it ends after 1 cycle; give 1 or less");
        if (transition.conditions.empty() && transition.exit == 0) {
            if (from == kNone)
                refuse(place,
                       "leaves any state at once, so that the layer never rests; give it 'when', 'exit' or 'from'");
            if (from == to) refuse(place, "begins its state again in every update; give it 'when' or 'exit'");
        }
        for (size_t i = 0; i < transition.conditions.size(); ++i)
            check_condition(transition.conditions, i, place_of(place, "when"));
    }

    void check_condition(const std::vector<ControllerCondition>& conditions, size_t i, const std::string& when) const {
        using Test = ControllerCondition::Test;
        const ControllerCondition& condition = conditions[i];
        const std::string place = place_of(when, condition.parameter),
                          name = "'" + printable(condition.parameter) + "'";
        const ParameterType type = controller_.parameters[parameters_.require(condition.parameter, place)].type;
        const bool compares = condition.test == Test::kAbove || condition.test == Test::kBelow;
        require_finite(condition.value, place);
        if (!is_known(condition.test, Test::kTriggered)) refuse(place, "its test is none of ControllerCondition::Test");
        if (type == ParameterType::kFloat && !compares)
            refuse(place, name, R"( is a float; compare it: {"above": 0.1}, {"below": 2})");
        if (type == ParameterType::kBool && (compares || condition.test == Test::kTriggered))
            refuse(place, name, " is a bool; ask for true or false");
        if (type == ParameterType::kTrigger && condition.test != Test::kTriggered)
            refuse(place, name, R"( is a trigger; ask for "triggered")");
        if (i == 0 || conditions[i - 1].parameter != condition.parameter) return;
        if (conditions[i - 1].test == Test::kAbove && condition.test == Test::kBelow &&
            !(conditions[i - 1].value < condition.value))
            refuse(place, "nothing is above ", text(conditions[i - 1].value), " and below ", text(condition.value));
    }

    const Controller& controller_;
    KnownNames parameters_{"parameter"}, masks_{"mask"};
};

}  // namespace

void check_rules(const Controller& controller) { Rules(controller).check(); }

}  // namespace throng
