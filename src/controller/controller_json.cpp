#include "controller/controller_json.h"

#include "base/failure.h"
#include "controller/controller_rules.h"
#include "controller/json_place.h"
#include "controller/known_names.h"
#include "import/json_view.h"
#include "import/uri.h"

#include <algorithm>
#include <cmath>

namespace throng {
namespace {

using Kind = JsonNode::Kind;

// One of some words; the first is the one that is meant where none is said.
size_t word_of(const JsonPlace& object, std::string_view key, std::initializer_list<std::string_view> words) {
    const auto member = object.find(key);
    if (!member) return 0;
    const auto found = std::find(words.begin(), words.end(), member->as_string());
    if (found != words.end()) return static_cast<size_t>(found - words.begin());
    std::string list;
    for (const std::string_view word : words) list += (list.empty() ? "\"" : " or \"") + std::string(word) + "\"";
    member->fail("must be " + list + ", but is '" + gltf::printable(member->as_string()) + "'");
}

// A name that refers to something: the empty one would mean none.
std::string name_or_none(const JsonPlace& object, std::string_view key) {
    const auto member = object.find(key);
    if (!member) return {};
    if (member->as_string().empty())
        member->fail("a name must not be empty; leave '" + std::string(key) + "' out for none");
    return member->as_string();
}

// A number; a parameter's name; or {"parameter", "times"}, their product.
void read_factor(const JsonPlace& object, std::string_view key, float& number, std::string& parameter) {
    const auto value = object.find(key);
    if (!value) return;
    if (value->kind() == Kind::kNumber) {
        number = value->as_float();
    } else if (value->is_string()) {
        parameter = name_or_none(object, key);
    } else if (value->kind() == Kind::kObject) {
        value->allow({"parameter", "times"});
        value->required("parameter");
        parameter = name_or_none(*value, "parameter");
        number = value->float_or("times", 1);
    } else {
        value->fail(R"(must be a number, a parameter's name, or {"parameter": …, "times": …})");
    }
}

ControllerParameter read_parameter(const JsonPlace& value) {
    if (value.kind() == Kind::kNumber) return {value.key(), ParameterType::kFloat, value.as_float()};
    if (value.kind() == Kind::kBool) return {value.key(), ParameterType::kBool, value.as_bool() ? 1.f : 0.f};
    if (value.is_string() && value.as_string() == "trigger") return {value.key(), ParameterType::kTrigger, 0};
    value.fail("must be a number, true, false or \"trigger\": the parameter's type, and what it begins with");
}

ControllerEvent read_event(const JsonPlace& event) {
    event.allow({"name", "clip", "at_s"});
    return {event.required("name").as_string(), event.required("clip").as_string(), event.required("at_s").as_number()};
}

MaskItem read_mask_item(const JsonPlace& item) {
    item.allow({"joint", "weight", "ramp"});
    const float ramp = item.float_or("ramp", 0);
    if (!(ramp >= 0 && ramp <= 65'535 && ramp == std::floor(ramp)))
        item.required("ramp").fail("must be a whole number of generations, 0 to 65535");
    return {item.required("joint").as_string(), item.float_or("weight", 1), static_cast<uint32_t>(ramp)};
}

BlendPoint read_point(const JsonPlace& point, bool of_two) {
    point.allow({"clip", "at"});
    const JsonPlace clip = point.required("clip"), at = point.required("at");
    if (!of_two) return {clip.as_string(), at.as_float(), 0};
    if (at.kind() != Kind::kArray || at.items().size() != 2)
        at.fail("must be two numbers, such as [0, 1]: the place in the two parameters of 'blend'");
    return {clip.as_string(), at.items()[0].as_float(), at.items()[1].as_float()};
}

void read_blend(const JsonPlace& state, ControllerState& out) {
    const JsonPlace blend = state.required("blend"), clips = state.required("clips");
    const bool of_two = blend.kind() == Kind::kArray;
    if (of_two) {
        if (blend.items().size() != 2) blend.fail("must be the name of a parameter, or of two: [\"x\", \"y\"]");
        out.x_parameter = blend.items()[0].as_string();
        out.y_parameter = blend.items()[1].as_string();
    } else {
        out.x_parameter = blend.as_string();
    }
    if (out.x_parameter.empty() || (of_two && out.y_parameter.empty())) blend.fail("a name must not be empty");
    for (const JsonPlace& point : clips.items()) out.points.push_back(read_point(point, of_two));
    if (out.points.empty()) clips.fail("must not be empty");
}

ControllerState read_state(const JsonPlace& state) {
    state.allow({"clip", "blend", "clips", "loop", "speed", "sync"});
    ControllerState out{.name = state.key(), .loop = state.bool_or("loop", true), .sync = name_or_none(state, "sync")};
    read_factor(state, "speed", out.speed, out.speed_parameter);
    const auto clip = state.find("clip");
    if (clip && (state.find("blend") || state.find("clips")))
        state.fail("has one 'clip', or a 'blend' of 'clips', not both");
    if (!clip && !state.find("blend") && !state.find("clips")) state.fail("'clip' is missing, or 'blend' and 'clips'");
    if (clip)
        out.points.push_back({clip->as_string()});
    else
        read_blend(state, out);
    return out;
}

void read_conditions(const JsonPlace& value, std::vector<ControllerCondition>& out) {
    using Test = ControllerCondition::Test;
    const auto add = [&](Test test, float number = 0) { out.push_back({value.key(), test, number}); };
    if (value.kind() == Kind::kBool) return add(value.as_bool() ? Test::kIsTrue : Test::kIsFalse);
    if (value.is_string() && value.as_string() == "triggered") return add(Test::kTriggered);
    if (value.kind() != Kind::kObject) value.fail(R"(must be true, false, "triggered", {"above": …} or {"below": …})");
    value.allow({"above", "below"});
    if (value.members().empty()) value.fail("'above' or 'below' is missing");
    if (const auto above = value.find("above")) add(Test::kAbove, above->as_float());
    if (const auto below = value.find("below")) add(Test::kBelow, below->as_float());
}

ControllerTransition read_transition(const JsonPlace& transition) {
    transition.allow({"from", "to", "when", "exit", "fade_s", "fade", "interrupts"});
    ControllerTransition out;
    out.from = name_or_none(transition, "from");
    if (out.from == "*") out.from.clear();
    out.to = transition.required("to").as_string();
    for (const JsonPlace& condition : transition.members("when")) read_conditions(condition, out.conditions);
    out.exit = transition.float_or("exit", 0);
    out.fade_s = transition.float_or("fade_s", 0);
    out.fade = word_of(transition, "fade", {"cross", "inertial"}) == 1 ? FadeKind::kInertial : FadeKind::kCross;
    out.interrupts = transition.bool_or("interrupts", false);
    return out;
}

ControllerLayer read_layer(const JsonPlace& layer) {
    layer.allow({"name", "mode", "rotations", "inertial", "mask", "weight", "start", "states", "transitions"});
    ControllerLayer out;
    out.name = layer.required("name").as_string();
    out.mode = word_of(layer, "mode", {"override", "additive"}) == 1 ? LayerMode::kAdditive : LayerMode::kOverride;
    out.model_space_rotations = word_of(layer, "rotations", {"local", "model"}) == 1;
    out.inertial_plays = layer.bool_or("inertial", false);
    out.mask = name_or_none(layer, "mask");
    read_factor(layer, "weight", out.weight, out.weight_parameter);
    const auto states = layer.find("states");
    for (const JsonPlace& state : layer.members("states")) out.states.push_back(read_state(state));
    if (states && out.states.empty())
        states->fail("must not be empty; leave it out for a layer that plays what it is told");
    for (const JsonPlace& transition : layer.items("transitions"))
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

}  // namespace

Controller read_controller(const JsonNode& root, const std::string& file) {
    const JsonPlace top(root, file);
    top.allow({"$schema", "parameters", "events", "masks", "layers"});
    if (const auto schema = top.find("$schema")) schema->as_string();
    Controller out;
    for (const JsonPlace& parameter : top.members("parameters")) out.parameters.push_back(read_parameter(parameter));
    for (const JsonPlace& event : top.items("events")) out.events.push_back(read_event(event));
    for (const JsonPlace& mask : top.members("masks")) {
        out.masks.push_back({mask.key(), {}});
        for (const JsonPlace& item : mask.items()) out.masks.back().items.push_back(read_mask_item(item));
    }
    for (const JsonPlace& layer : top.required("layers").items()) out.layers.push_back(read_layer(layer));
    return out;
}

Result<Controller> parse_controller(std::string_view json, std::string_view name) {
    const std::string file = gltf::printable(name, 120);
    return as_result(
        [&] {
            const JsonNode root = parse_json_lines(json, file);
            Controller controller = read_controller(root, file);
            controller.name = name;
            const auto rules = as_result([&] { check_rules(controller); });
            if (rules) return controller;
            const auto& [code, place, message] = rules.error();
            throw Failure(code == ErrorCode::kInvalidArgument ? ErrorCode::kInvalidFile : code,
                          located(file, line_of(root, place), place), message);
        },
        file);
}

Result<Controller> load_controller(const std::filesystem::path& path) {
    const std::string name = path.filename().string(), file = gltf::printable(name, 120);
    const auto bytes = as_result(
        [&] {
            std::error_code unknown;
            if (std::filesystem::is_regular_file(path, unknown) &&
                std::filesystem::file_size(path, unknown) > kJsonTextLimit_bytes)
                throw Failure(ErrorCode::kLimit, file, kJsonTextLimitMessage);
            return gltf::read_file(path, kJsonTextLimit_bytes, file);
        },
        file);
    if (!bytes) return bytes.error();
    return parse_controller({reinterpret_cast<const char*>(bytes->data()), bytes->size()}, name);
}

}  // namespace throng
