#include "base/text.h"
#include "tools/cli/command.h"
#include "tools/controller/controller_text.h"
#include "tools/controller/graphviz.h"
#include "tools/cli/inputs.h"
#include "tools/commands.h"

#include <throng/controller.h>

#include <nlohmann/json.hpp>

#include <cstdio>

namespace throng::tools {
namespace {

struct CheckOptions {
    std::string file;
    std::vector<std::string> characters;
    bool json = false;
};

const char* type_name(ParameterType type) {
    return type == ParameterType::kFloat ? "float" : type == ParameterType::kBool ? "bool" : "trigger";
}
const char* mode_name(LayerMode mode) { return mode == LayerMode::kAdditive ? "additive" : "override"; }

std::string initial_text(const ControllerParameter& parameter) {
    if (parameter.type == ParameterType::kTrigger) return {};
    if (parameter.type == ParameterType::kBool)
        return parameter.initial != 0 ? ", initially true" : ", initially false";
    return ", initially " + number_text(parameter.initial);
}

nlohmann::json to_json(const Controller& controller, const CheckOptions& options,
                       const std::vector<std::string>& warnings) {
    nlohmann::json parameters = nlohmann::json::array(), masks = parameters, events = parameters, layers = parameters;
    for (const ControllerParameter& parameter : controller.parameters)
        parameters.push_back(
            {{"name", parameter.name}, {"type", type_name(parameter.type)}, {"initial", parameter.initial}});
    for (const JointMask& mask : controller.masks) masks.push_back(mask.name);
    for (const ControllerEvent& event : controller.events)
        events.push_back({{"name", event.name}, {"clip", event.clip}, {"at_s", event.time_s}});
    for (const ControllerLayer& layer : controller.layers) {
        nlohmann::json states = nlohmann::json::array(), transitions = states;
        for (const ControllerState& state : layer.states)
            states.push_back({{"name", state.name},
                              {"motion", motion_text(state)},
                              {"loop", state.loop},
                              {"speed", factor_text(state.speed, state.speed_parameter)}});
        for (const ControllerTransition& transition : layer.transitions)
            transitions.push_back({{"from", transition.from.empty() ? "*" : transition.from},
                                   {"to", transition.to},
                                   {"when", conditions_text(transition)}});
        layers.push_back({{"name", layer.name},
                          {"mode", mode_name(layer.mode)},
                          {"rotations", layer.model_space_rotations ? "model" : "local"},
                          {"inertial", layer.inertial_plays},
                          {"mask", layer.mask},
                          {"weight", factor_text(layer.weight, layer.weight_parameter)},
                          {"states", states},
                          {"transitions", transitions}});
    }
    return {{"file", options.file},     {"characters", options.characters},
            {"parameters", parameters}, {"masks", masks},
            {"events", events},         {"layers", layers},
            {"warnings", warnings}};
}

void print_layer(const ControllerLayer& layer, size_t index) {
    const std::string mask = (layer.model_space_rotations ? ", rotations in model space" : "") +
                             (layer.mask.empty() ? "" : ", mask " + layer.mask);
    std::printf("  layer %-4zu %s: %s%s, weight %s", index, layer.name.c_str(), mode_name(layer.mode), mask.c_str(),
                factor_text(layer.weight, layer.weight_parameter).c_str());
    if (layer.states.empty())
        std::printf("; no states: plays what Crowd::play() sets\n");
    else
        std::printf("; %zu states, %zu transitions\n", layer.states.size(), layer.transitions.size());
    for (const ControllerState& state : layer.states) {
        const std::string how = play_text(state);
        std::printf("    %-14s %s%s%s\n", state.name.c_str(), motion_text(state).c_str(), how.empty() ? "" : ", ",
                    how.c_str());
    }
    for (const ControllerTransition& transition : layer.transitions) {
        const std::string from = transition.from.empty() ? "(any)" : transition.from;
        std::string how = conditions_text(transition);
        for (const std::string& part : timing_text(transition)) how += (how.empty() ? "" : "; ") + part;
        std::printf("    %-14s -> %s: %s\n", from.c_str(), transition.to.c_str(),
                    how.empty() ? "at once" : how.c_str());
    }
}

void print_text(const Controller& controller, const CheckOptions& options) {
    size_t state_count = 0, transition_count = 0;
    for (const ControllerLayer& layer : controller.layers) {
        state_count += layer.states.size();
        transition_count += layer.transitions.size();
    }
    std::printf("%s: %zu parameters, %zu masks, %zu layers, %zu states, %zu transitions, %zu events\n",
                printable(options.file, std::string::npos).c_str(), controller.parameters.size(),
                controller.masks.size(), controller.layers.size(), state_count, transition_count,
                controller.events.size());
    for (const ControllerParameter& parameter : controller.parameters)
        std::printf("  parameter  %-14s %s%s\n", parameter.name.c_str(), type_name(parameter.type),
                    initial_text(parameter).c_str());
    for (const JointMask& mask : controller.masks)
        std::printf("  mask       %-14s %zu items\n", mask.name.c_str(), mask.items.size());
    for (size_t i = 0; i < controller.layers.size(); ++i) print_layer(controller.layers[i], i);
    for (const ControllerEvent& event : controller.events)
        std::printf("  event      %-14s %s at %.4g s\n", event.name.c_str(), event.clip.c_str(), event.time_s);
    for (const std::string& character : options.characters) std::printf("  drives     %s\n", character.c_str());
}

void run_check(const CheckOptions& options) {
    const Controller controller = unwrap(load_controller(options.file));
    const CompileSettings quickly{.error = 0, .lods = false};  // or compiling would take longer than the check
    std::vector<std::string> warnings = controller_warnings(controller);
    for (const Character& character : load_characters(options.characters, quickly)) {
        unwrap(check_controller(controller, character));
        for (std::string& warning : controller_warnings(controller, character)) warnings.push_back(std::move(warning));
    }
    print_warnings(warnings);
    if (options.json)
        print_json(to_json(controller, options, warnings));
    else
        print_text(controller, options);
}

void add_check(Command controller) {
    Command command = controller.add_subcommand("check",
                                                "what is in a controller, and whether it can drive characters");
    auto options = std::make_shared<CheckOptions>();
    command.add_option("file", options->file, "a controller's .json file").required();
    command.add_option("--character", options->characters,
                       "glTF 2.0 or .throng files to check for the controller's clips and joints");
    command.add_flag("--json", options->json, "as JSON");
    command.footer(
        "Examples:\n  throng controller check guard.json\n  throng controller check guard.json --character knight.glb\n"
        "  throng controller check guard.json --json | jq '.layers[].states[].name'");
    command.callback([options] { run_check(*options); });
}

void add_graph(Command controller) {
    struct GraphOptions {
        std::string file, out;
    };
    Command command = controller.add_subcommand("graph", "draw a controller's states and transitions");
    auto options = std::make_shared<GraphOptions>();
    command.add_option("file", options->file, "a controller's .json file").required();
    const auto check_kind = [](const std::string& name) {
        return name.ends_with(".svg") || name.ends_with(".dot") ? ""
                                                                : "'" + name + "' ends neither in .svg nor in .dot";
    };
    command.add_option("-o,--out", options->out, "the .svg file to write, or a .dot file for Graphviz")
        .required()
        .check(Check(check_kind))
        .check(writable_file());
    command.footer(
        "Examples:\n  throng controller graph guard.json -o guard.svg\n"
        "  throng controller graph guard.json -o guard.dot && dot -Tpng guard.dot > guard.png");
    command.callback([options] {
        protect_inputs({options->file}, {options->out});
        const std::string graph = controller_graph(unwrap(load_controller(options->file)));
        const std::string content = options->out.ends_with(".svg") ? run_graphviz(graph) : graph;
        write_file(options->out, std::as_bytes(std::span(content)));
    });
}

}  // namespace

void add_controller(Command app) {
    Command command = app.add_subcommand("controller",
                                         "check and draw controllers: state machines that decide what characters play");
    command.require_subcommand("check or graph");
    command.footer("'throng controller check --help' and 'graph --help' have examples.");
    add_check(command);
    add_graph(command);
}

}  // namespace throng::tools
