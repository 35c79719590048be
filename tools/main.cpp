#include "tools/command.h"
#include "tools/options.h"

#include <cstdio>
#include <iostream>

namespace {

void add_commands(throng::tools::Command app) {
    using namespace throng::tools;
    add_info(app);
    add_compile(app);
    add_controller(app);
    add_pose(app);
    add_render(app);
    add_view(app);
    add_generate(app);
    add_bench(app);
    add_tune(app);
    add_devices(app);
}

}  // namespace

int main(int argc, char** argv) {
    using namespace throng::tools;
    try {
        run_command_line(argc, argv, THRONG_VERSION, add_commands);
    } catch (const UsageError& error) {
        std::cerr << "throng: " << error.what() << " (throng --help)\n";
        return 2;
    } catch (const std::exception& error) {
        print_progress("");
        std::cerr << "throng: " << error.what() << "\n";
        return 1;
    }
    std::cout.flush();
    if (std::fflush(stdout) == 0 && !std::ferror(stdout)) return 0;
    std::cerr << "throng: standard output: cannot be written\n";
    return 1;
}
