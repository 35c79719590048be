#include "tools/command.h"
#include "tools/options.h"

#include <CLI/CLI.hpp>

#include <cstdio>
#include <iostream>

int main(int argc, char** argv) {
    using namespace throng::tools;
    CLI::App app{"throng: GPU skeletal animation for crowds"};
    app.name("throng");
    app.set_version_flag("--version", THRONG_VERSION);
    app.require_subcommand(0, 1);  // none is said below: with 1, a misspelt one would not be named
    app.footer("'throng COMMAND --help' has examples. Exit code: 0 done, 1 failed, more than 1 a wrong option.");
    const Command command(app);
    add_info(command);
    add_compile(command);
    add_controller(command);
    add_pose(command);
    add_render(command);
    add_view(command);
    add_generate(command);
    add_bench(command);
    add_tune(command);
    add_devices(command);
    try {
        app.parse(argc, argv);
        if (app.get_subcommands().empty()) throw CLI::RequiredError("A command");
    } catch (const CLI::Success& help_or_version) {
        app.exit(help_or_version);  // prints it
    } catch (const CLI::ParseError& error) {
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
