#include "tools/command.h"

#include <cstdio>
#include <iostream>

int main(int argc, char** argv) {
    using namespace throng::tools;
    CLI::App app{"throng: GPU skeletal animation for crowds"};
    app.name("throng");
    app.set_version_flag("--version", THRONG_VERSION);
    app.require_subcommand(1);
    app.footer("'throng COMMAND --help' has examples. Exit code: 0 done, 1 failed, more than 1 a wrong option.");
    add_info(app);
    add_pose(app);
    add_render(app);
    add_generate(app);
    add_bench(app);
    add_devices(app);
    try {
        app.parse(argc, argv);
        std::cout.flush();
        return std::fflush(stdout) == 0 && !std::ferror(stdout) ? 0 : throw CommandError("standard output: cannot be written");
    } catch (const CLI::Success& success) {  // --help, --version
        return app.exit(success);
    } catch (const CLI::ParseError& error) {
        std::cerr << "throng: " << error.what() << " (throng --help)\n";
        return 2;
    } catch (const std::exception& error) {
        print_progress("");
        std::cerr << "throng: " << error.what() << "\n";
        return 1;
    }
}
