#include "tools/controller/controller_text.h"
#include "tools/controller/graphviz.h"

namespace throng::tools {
namespace {

constexpr const char* kHead = R"(digraph controller {
  graph [fontname="Helvetica", fontsize=14, labeljust=l, style="rounded", color="#9aa5b1", bgcolor="white", )"
                              R"(nodesep=0.35, ranksep=0.6];
  node [fontname="Helvetica", fontsize=12, shape=box, style="rounded,filled", color="#52606d", fillcolor="#e4edf7"];
  edge [fontname="Helvetica", fontsize=10, color="#52606d", fontcolor="#323f4b", arrowsize=0.7];
)";

// Lines of a label: Graphviz breaks them at "\n".
std::string label(const std::vector<std::string>& lines) {
    std::string text;
    for (const std::string& line : lines) {
        const std::string quoted = graphviz_text(line);
        if (line.empty()) continue;
        text += (text.empty() ? "" : "\\n") + quoted.substr(1, quoted.size() - 2);
    }
    return "label=\"" + text + "\"";
}

std::string layer_label(const ControllerLayer& layer) {
    std::string how = layer.mode == LayerMode::kAdditive ? "additive" : "override";
    if (layer.model_space_rotations) how += ", rotations in model space";
    if (!layer.mask.empty()) how += ", mask " + layer.mask;
    if (const std::string weight = factor_text(layer.weight, layer.weight_parameter); weight != "1")
        how += ", weight " + weight;
    return label({layer.name + " (" + how + ")"});
}

// Like motion_text(), but gives only the number of clips if there are many, which keeps the node narrow.
std::string short_motion_text(const ControllerState& state) {
    if (state.points.size() <= 3) return motion_text(state);
    return std::to_string(state.points.size()) + " clips by " + state.x_parameter +
           (state.y_parameter.empty() ? "" : " and " + state.y_parameter);
}

std::string state_node(const std::string& id, const ControllerState& state, bool is_first) {
    return "    " + id + " [" + label({state.name, short_motion_text(state), play_text(state)}) +
           (is_first ? ", penwidth=2.5" : "") + "];\n";
}

std::string transition_edge(const std::string& from, const std::string& to, const ControllerTransition& transition) {
    std::string timing;
    for (const std::string& part : timing_text(transition)) timing += (timing.empty() ? "" : ", ") + part;
    const std::string style = transition.fade == FadeKind::kInertial ? ", style=dashed" : "";
    // Keeps the label off the edge
    const auto beside = [](const std::string& line) { return line.empty() ? line : " " + line + " "; };
    return "    " + from + " -> " + to + " [" + label({beside(conditions_text(transition)), beside(timing)}) + style +
           "];\n";
}

std::string layer_cluster(const ControllerLayer& layer, size_t index) {
    const std::string prefix = "layer" + std::to_string(index) + "_";
    const auto id_of = [&](const std::string& state) {
        size_t i = 0;
        while (layer.states[i].name != state) ++i;
        return prefix + "state" + std::to_string(i);
    };
    std::string text = "  subgraph cluster_" + std::to_string(index) + " {\n    " + layer_label(layer) + ";\n", edges;
    if (layer.states.empty())
        text += "    " + prefix + "direct [label=\"plays what Crowd::play() sets\", style=dashed];\n";
    for (const ControllerState& state : layer.states)
        text += state_node(id_of(state.name), state, &state == layer.states.data());
    bool from_any = false;
    for (const ControllerTransition& transition : layer.transitions) {
        edges += transition_edge(transition.from.empty() ? prefix + "any" : id_of(transition.from),
                                 id_of(transition.to), transition);
        from_any = from_any || transition.from.empty();
    }
    if (from_any) text += "    " + prefix + "any [label=\"any state\", shape=ellipse, style=dashed];\n";
    return text + edges + "  }\n";
}

}  // namespace

std::string controller_graph(const Controller& controller) {
    std::string text = kHead;
    for (size_t i = 0; i < controller.layers.size(); ++i) text += layer_cluster(controller.layers[i], i);
    return text + "}\n";
}

}  // namespace throng::tools
