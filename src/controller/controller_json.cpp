// Controllers as JSON: docs/controller.md, docs/controller.schema.json.
#include "base/read_file.h"
#include "controller/controller_rules.h"
#include "json/json_text.h"
#include "json/known_names.h"

#include <throng/controller.h>

#include <algorithm>
#include <cmath>

namespace throng {
namespace {

constexpr const char* kTooLarge = "is larger than the limit of 4 MiB";

// The index of the member's value in `words`; 0, the default, if the member is absent.
size_t word_of(const JsonView& object, std::string_view key, std::initializer_list<std::string_view> words) {
    const auto member = object.find(key);
    if (!member) return 0;
    const auto found = std::find(words.begin(), words.end(), member->as_string());
    if (found != words.end()) return static_cast<size_t>(found - words.begin());
    std::string list;
    for (const std::string_view word : words) list += joined(list.empty() ? "\"" : " or \"", word, "\"");
    member->fail("must be ", list, ", but is '", printable(member->as_string()), "'");
}

// A name that refers to something: the empty one would mean none.
std::string name_or_none(const JsonView& object, std::string_view key) {
    const auto member = object.find(key);
    if (!member) return {};
    if (member->as_string().empty()) member->fail("a name must not be empty; leave '", key, "' out for none");
    return member->as_string();
}

// A number; a parameter's name; or {"parameter", "times"}, their product.
void read_factor(const JsonView& object, std::string_view key, float& number, std::string& parameter) {
    const auto value = object.find(key);
    if (!value) return;
    if (value->is_number()) {
        number = value->as_float();
    } else if (value->is_string()) {
        parameter = name_or_none(object, key);
    } else if (value->is_object()) {
        value->allow({"parameter", "times"});
        value->required("parameter");
        parameter = name_or_none(*value, "parameter");
        number = value->optional_float("times", 1);
    } else {
        value->fail(R"(must be a number, a parameter's name, or {"parameter": …, "times": …})");
    }
}

ControllerParameter read_parameter(const JsonView& value) {
    if (value.is_number()) return {value.key(), ParameterType::kFloat, value.as_float()};
    if (value.is_bool()) return {value.key(), ParameterType::kBool, value.as_bool() ? 1.f : 0.f};
    if (value.is_string() && value.as_string() == "trigger") return {value.key(), ParameterType::kTrigger, 0};
    value.fail("must be a number, true, false or \"trigger\": the parameter's type and initial value");
}

ControllerEvent read_event(const JsonView& event) {
    event.allow({"name", "clip", "at_s"});
    return {event.required_string("name"), event.required_string("clip"), event.required("at_s").as_number()};
}

MaskItem read_mask_item(const JsonView& item) {
    item.allow({"joint", "weight", "ramp"});
    const float ramp = item.optional_float("ramp", 0);
    if (!(ramp >= 0 && ramp <= 65'535 && ramp == std::floor(ramp)))
        item.required("ramp").fail("must be a whole number of generations, 0 to 65535");
    return {item.required_string("joint"), item.optional_float("weight", 1), static_cast<uint32_t>(ramp)};
}

BlendPoint read_point(const JsonView& point, bool of_two) {
    point.allow({"clip", "at"});
    const JsonView clip = point.required("clip"), at = point.required("at");
    if (!of_two) return {clip.as_string(), at.as_float(), 0};
    if (!at.is_array() || at.size() != 2)
        at.fail("must be two numbers, such as [0, 1]: the place in the two parameters of 'blend'");
    return {clip.as_string(), at[0].as_float(), at[1].as_float()};
}

void read_blend(const JsonView& state, ControllerState& out) {
    const JsonView blend = state.required("blend"), clips = state.required("clips");
    const bool of_two = blend.is_array();
    if (of_two) {
        if (blend.size() != 2) blend.fail("must be the name of a parameter, or of two: [\"x\", \"y\"]");
        out.x_parameter = blend[0].as_string();
        out.y_parameter = blend[1].as_string();
    } else {
        out.x_parameter = blend.as_string();
    }
    if (out.x_parameter.empty() || (of_two && out.y_parameter.empty())) blend.fail("a name must not be empty");
    for (const JsonView point : clips.as_array()) out.points.push_back(read_point(point, of_two));
    if (out.points.empty()) clips.fail("must not be empty");
}

ControllerState read_state(const JsonView& state) {
    state.allow({"clip", "blend", "clips", "loop", "speed", "sync"});
    ControllerState out{
        .name = state.key(), .loop = state.optional_bool("loop", true), .sync = name_or_none(state, "sync")};
    read_factor(state, "speed", out.speed, out.speed_parameter);
    const auto clip = state.find("clip");
    if (clip && (state.find("blend") || state.find("clips")))
        state.fail("must have one 'clip', or a 'blend' of 'clips', not both");
    if (!clip && !state.find("blend") && !state.find("clips")) state.fail("must have a 'clip', or 'blend' and 'clips'");
    if (!clip)
        read_blend(state, out);
    else if (!clip->is_null())
        out.points.push_back({clip->as_string()});
    return out;
}

void read_conditions(const JsonView& value, std::vector<ControllerCondition>& out) {
    using Test = ControllerCondition::Test;
    const auto add = [&](Test test, float number = 0) { out.push_back({value.key(), test, number}); };
    if (value.is_bool()) return add(value.as_bool() ? Test::kIsTrue : Test::kIsFalse);
    if (value.is_string() && value.as_string() == "triggered") return add(Test::kTriggered);
    if (!value.is_object()) value.fail(R"(must be true, false, "triggered", {"above": …} or {"below": …})");
    value.allow({"above", "below"});
    if (value.size() == 0) value.fail("'above' or 'below' is missing");
    if (const auto above = value.find("above")) add(Test::kAbove, above->as_float());
    if (const auto below = value.find("below")) add(Test::kBelow, below->as_float());
}

ControllerTransition read_transition(const JsonView& transition) {
    transition.allow({"from", "to", "when", "exit", "fade_s", "fade", "interrupts"});
    ControllerTransition out;
    out.from = name_or_none(transition, "from");
    if (out.from == "*") out.from.clear();
    out.to = transition.required_string("to");
    for (const JsonView condition : transition.optional_members("when")) read_conditions(condition, out.conditions);
    out.exit = transition.optional_float("exit", 0);
    out.fade_s = transition.optional_float("fade_s", 0);
    out.fade = word_of(transition, "fade", {"cross", "inertial"}) == 1 ? FadeKind::kInertial : FadeKind::kCross;
    out.interrupts = transition.optional_bool("interrupts", false);
    return out;
}

ControllerLayer read_layer(const JsonView& layer) {
    layer.allow({"name", "mode", "rotations", "inertial", "mask", "weight", "start", "states", "transitions"});
    ControllerLayer out;
    out.name = layer.required_string("name");
    out.mode = word_of(layer, "mode", {"override", "additive"}) == 1 ? LayerMode::kAdditive : LayerMode::kOverride;
    out.model_space_rotations = word_of(layer, "rotations", {"local", "model"}) == 1;
    out.inertial_plays = layer.optional_bool("inertial", false);
    out.mask = name_or_none(layer, "mask");
    read_factor(layer, "weight", out.weight, out.weight_parameter);
    const auto states = layer.find("states");
    for (const JsonView state : layer.optional_members("states")) out.states.push_back(read_state(state));
    if (states && out.states.empty())
        states->fail("must not be empty; leave it out for a layer that plays clips by Crowd::play()");
    for (const JsonView transition : layer.optional_array("transitions"))
        out.transitions.push_back(read_transition(transition));
    if (const auto start = layer.find("start")) {
        KnownNames names("state");
        for (const ControllerState& state : out.states) names.add(state.name);
        const uint32_t first = names.find(start->as_string());
        if (first == kNone) start->fail(names.unknown(start->as_string()));
        // The others keep their order
        std::rotate(out.states.begin(), out.states.begin() + first, out.states.begin() + first + 1);
    }
    return out;
}

// Reads types, fields and their order; check_rules() checks how the values fit together.
Controller read_controller(const JsonView& top) {
    top.allow({"$schema", "parameters", "events", "masks", "layers"});
    if (const auto schema = top.find("$schema")) schema->as_string();
    Controller out;
    for (const JsonView parameter : top.optional_members("parameters"))
        out.parameters.push_back(read_parameter(parameter));
    for (const JsonView event : top.optional_array("events")) out.events.push_back(read_event(event));
    for (const JsonView mask : top.optional_members("masks")) {
        out.masks.push_back({mask.key(), {}});
        for (const JsonView item : mask.as_array()) out.masks.back().items.push_back(read_mask_item(item));
    }
    for (const JsonView layer : top.required_array("layers")) out.layers.push_back(read_layer(layer));
    return out;
}

}  // namespace

Result<Controller> parse_controller(std::string_view json, std::string_view name) {
    const std::string file = printable(name, 120);
    return as_result(
        [&] {
            if (json.size() > kJsonTextLimit_bytes) throw Failure(ErrorCode::kLimit, file, kTooLarge);
            const JsonText text(json, JsonAuthor::kPerson, file);
            try {
                Controller controller = read_controller(text.view());
                controller.name = name;
                check_rules(controller);
                return controller;
            } catch (const Failure& failure) {
                const auto& [code, place, message] = failure.error;
                throw Failure(code == ErrorCode::kInvalidArgument ? ErrorCode::kInvalidFile : code,
                              text.located(file, place), message);
            }
        },
        file);
}

Result<Controller> load_controller(const std::filesystem::path& path) {
    const std::string name = path.filename().string(), file = printable(name, 120);
    const auto bytes = as_result([&] { return read_file(path, kJsonTextLimit_bytes, file, kTooLarge); }, file);
    if (!bytes) return bytes.error();
    return parse_controller({reinterpret_cast<const char*>(bytes->data()), bytes->size()}, name);
}

}  // namespace throng
