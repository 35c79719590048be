// Graphviz as a child process.
#pragma once

#include <string>

namespace throng::tools {

// A graph in Graphviz's language as SVG. Throws CommandError where Graphviz is not installed or does not understand the
// graph.
std::string run_graphviz(const std::string& graph);

// `text` as a string of that language: of one line, and nothing in it is an escape or the string's end.
std::string graphviz_text(const std::string& text);

}  // namespace throng::tools
