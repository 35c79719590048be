#include "tools/cli/program.h"

#include "base/text.h"
#include "tools/cli/command.h"

#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <iostream>

namespace throng::tools {

void exec_program(const OwnProgram& program, char** argv) {
    std::error_code failure;
    const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", failure);
    const std::string path = self.parent_path() / program.program;
    if (!failure) ::execv(path.c_str(), argv);
    throw CommandError(std::string(program.command) + ": " + path +
                       " cannot be started: " + std::strerror(failure ? failure.value() : errno) +
                       ": is it installed? (In a checkout, './run build' builds it)");
}

int run_program(int argc, char** argv, void (*run)(int argc, char** argv)) {
    std::signal(SIGXFSZ, SIG_IGN);  // a file that gets too large is an error with a message
    std::signal(SIGCHLD, SIG_DFL);  // if the parent ignored it, waitpid() could not tell how a child ended
    try {
        run(argc, argv);
    } catch (const UsageError& error) {
        print_progress("");
        // Arguments may contain anything
        std::cerr << "throng: " << printable(error.what(), std::string::npos) << "\n";
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

}  // namespace throng::tools
