// Graphviz as a child process.
#pragma once

#include <string>

namespace throng::tools {

// Draws a graph in Graphviz's language as SVG. Throws CommandError if Graphviz is not installed or does not understand
// the graph.
std::string run_graphviz(const std::string& graph);

// `text` as a string of that language: on one line, and nothing in it acts as an escape or ends the string.
std::string graphviz_text(const std::string& text);

}  // namespace throng::tools
