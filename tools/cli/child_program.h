// Another program as a child process.
#pragma once

#include <string>
#include <vector>

namespace throng {

struct ChildOutput {
    std::string output, errors;
    int status = 0;  // 0: it ended well
    enum class Start { kStarted, kMissing, kRefused } start = Start::kStarted;
};

// Finds a program by its name and runs it to its end, with `input` as its standard input. Throws kFile if there is no
// memory for its streams, or if the system does not tell how the program ended, as where SIGCHLD is ignored.
ChildOutput run_child_program(std::vector<std::string> name_and_arguments, const std::string& input);

}  // namespace throng
