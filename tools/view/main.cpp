#include "tools/cli/program.h"
#include "tools/view/view.h"

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

namespace {

using namespace throng::tools;

void add_commands(Command app) { add_view(app); }

// `throng-view` by itself is `throng view`.
void run(int argc, char** argv) {
    std::vector<char*> words(argv, argv + argc);
    std::string view = "view";
    if (argc < 2 || (argv[1] != view && argv[1] != std::string_view("--version")))
        words.insert(words.begin() + std::min(argc, 1), view.data());
    run_command_line(static_cast<int>(words.size()), words.data(), add_commands);
}

}  // namespace

int main(int argc, char** argv) { return run_program(argc, argv, run); }
