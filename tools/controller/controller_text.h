// Controllers in words, for people: what 'throng controller' prints and draws.
#pragma once

#include <throng/controller.h>

#include <string>
#include <vector>

namespace throng::tools {

std::string number_text(float value);

// "idle"; "walk at 1.4, run at 4 by speed"
std::string motion_text(const ControllerState& state);

// "once, speed -1"; empty if it loops at speed 1
std::string play_text(const ControllerState& state);

// "speed > 0.1, alert, not tired, jump triggered"; empty without conditions
std::string conditions_text(const ControllerTransition& transition);

// "after 0.9 cycles", "0.2 s inertial", "interrupts": those that apply
std::vector<std::string> timing_text(const ControllerTransition& transition);

// What a number is multiplied by: "0.5", "pace", "0.5 * pace"
std::string factor_text(float number, const std::string& parameter);

// Probable mistakes, one per line: states that no transitions lead to, transitions that cannot be taken.
std::vector<std::string> controller_warnings(const Controller& controller);
// Probable mistakes with this character: clips that share their name, transitions that wait for the end of clips
// without length.
std::vector<std::string> controller_warnings(const Controller& controller, const Character& character);

// A graph in Graphviz's language: a cluster for each layer, a node for each state, an edge for each transition.
std::string controller_graph(const Controller& controller);

}  // namespace throng::tools
