// What the command-line programs share: `throng`, and the programs beside it that implement some of its commands.
#pragma once

#include "tools/cli/options.h"

namespace throng::tools {

// A command that is a program of its own, so that people who only draw need not build the benchmarks or the viewer.
struct OwnProgram {
    const char *command, *program, *description;
};
inline constexpr OwnProgram kBench{"bench", "throng-bench",
                                   "milliseconds per stage, checked against the reference first"},
    kTune{"tune", "throng-bench", "measure what scans cost on this device, for --scan auto to choose by"},
    kView{"view", "throng-view",
          "a window with a crowd of one or several files: fly through it, change it, look at one; keys by ?"};

// Replaces this process by the program, which lies beside this one. Never returns; throws CommandError if it cannot.
[[noreturn]] void become(const OwnProgram& program, char** argv);

// Returns the exit code of main(). `run` may throw; the message goes to stderr, as one line.
int run_program(int argc, char** argv, void (*run)(int argc, char** argv));

}  // namespace throng::tools
