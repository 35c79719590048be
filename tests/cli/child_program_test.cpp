// run_child_program(): how it reports a child process whose exit status the system does not give.
#include "base/failure.h"
#include "tools/cli/child_program.h"

#include <gtest/gtest.h>

#include <csignal>

namespace throng {
namespace {

TEST(ChildProgram, AnUnknownExitStatusIsAnError) {
    const auto before = std::signal(SIGCHLD, SIG_IGN);
    EXPECT_THROW(run_child_program({"false"}, ""), Failure);
    std::signal(SIGCHLD, before);
    EXPECT_NE(run_child_program({"false"}, "").status, 0);
    EXPECT_EQ(run_child_program({"true"}, "").status, 0);
}

}  // namespace
}  // namespace throng
