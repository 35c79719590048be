#include "tools/cli/program.h"
#include "tools/view/view.h"

namespace {

using namespace throng::tools;

void add_commands(Command app) { add_view(app); }

void run(int argc, char** argv) { run_command_line(argc, argv, add_commands); }

}  // namespace

int main(int argc, char** argv) { return run_program(argc, argv, run); }
