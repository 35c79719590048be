#include "tools/cli/program.h"
#include "tools/commands.h"

#include <string_view>

namespace {

using namespace throng::tools;

constexpr OwnProgram kOwnPrograms[] = {kView, kBench, kTune};

void add_commands(Command app) {
    add_info(app);
    add_compile(app);
    add_controller(app);
    add_pose(app);
    add_render(app);
    add_generate(app);
    add_devices(app);
    for (const OwnProgram& program : kOwnPrograms) app.add_subcommand(program.command, program.description);
}

void run(int argc, char** argv) {
    for (const OwnProgram& program : kOwnPrograms)
        if (argc > 1 && argv[1] == std::string_view(program.command)) exec_program(program, argv);
    run_command_line(argc, argv, add_commands);
}

}  // namespace

int main(int argc, char** argv) { return run_program(argc, argv, run); }
