// What the command-line programs share: `throng`, and the programs beside it that implement some of its commands.
#pragma once

#include "tools/cli/options.h"

namespace throng::tools {

// A command that is a program of its own, so that people who only draw need not build the benchmarks or the viewer.
struct OwnProgram {
    const char *command, *program, *description;
};
inline constexpr OwnProgram kBench{"bench", "throng-bench",
                                   "measure milliseconds per stage, after a check against the reference"},
    kTune{"tune", "throng-bench", "measure what scans cost on this device, so that --scan auto chooses by it"},
    kView{"view", "throng-view",
          "show a crowd of one or several files in a window: fly through it, change it, inspect characters; ? lists "
          "the keys"};

// Replaces this process by the program, which lies beside this one. Never returns; throws CommandError if it cannot.
[[noreturn]] void exec_program(const OwnProgram& program, char** argv);

// Returns the exit code of main(). `run` may throw; the message goes to stderr, as one line.
int run_program(int argc, char** argv, void (*run)(int argc, char** argv));

}  // namespace throng::tools
