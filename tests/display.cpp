#include "tests/display.h"

#include <csignal>
#include <cstdio>
#include <fcntl.h>
#include <stdexcept>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

namespace throng::test {

Display::Display(const char* screen) {
    int ends[2];
    if (pipe(ends) != 0) throw std::runtime_error("pipe() failed");
    server_ = fork();
    if (server_ == 0) {
        prctl(PR_SET_PDEATHSIG, SIGTERM);  // also if the test crashes
        close(ends[0]);
        if (const int null = open("/dev/null", O_WRONLY); null >= 0) dup2(null, STDERR_FILENO);
        const std::string descriptor = std::to_string(ends[1]);
        execlp("Xvfb", "Xvfb", "-displayfd", descriptor.c_str(), "-screen", "0", screen, "-nolisten", "tcp", nullptr);
        _exit(127);
    }
    close(ends[1]);
    // Xvfb writes the display number that it has chosen once it accepts connections.
    for (char c = 0; read(ends[0], &c, 1) == 1 && c != '\n';) name_ += c;
    close(ends[0]);
    if (name_.empty()) throw std::runtime_error("Xvfb does not start: is the package xvfb installed?");
    name_.insert(0, ":");
}

Display::~Display() {
    kill(server_, SIGTERM);
    waitpid(server_, nullptr, 0);
}

}  // namespace throng::test
