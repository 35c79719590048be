#include "tools/controller/graphviz.h"

#include "tools/cli/child_program.h"
#include "tools/cli/command.h"

namespace throng::tools {

std::string run_graphviz(const std::string& graph) {
    using Start = ChildOutput::Start;
    const ChildOutput child = run_child_program({"dot", "-Tsvg"}, graph);
    if (child.start == Start::kMissing)
        throw CommandError(
            "dot: Graphviz is not installed, and is needed to draw the SVG (Debian: apt-get install graphviz); a .dot "
            "file can be written without it");
    if (child.start == Start::kRefused) throw CommandError("dot: cannot be started: " + child.errors);
    if (child.status != 0) throw CommandError("dot: " + child.errors.substr(0, child.errors.find('\n')));
    return child.output;
}

std::string graphviz_text(const std::string& text) {
    std::string quoted = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\') quoted += '\\';
        quoted += static_cast<unsigned char>(c) < ' ' ? ' ' : c;
    }
    return quoted + '"';
}

}  // namespace throng::tools
