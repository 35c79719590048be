// create_file() on file systems that lack hard links, or also renameat2() without replacing: files are written whole.
#include "base/replace_file.h"
#include "tests/files.h"

#include <gtest/gtest.h>

#include <cerrno>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <iterator>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <span>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>
#include <vector>

namespace throng {
namespace {

using namespace test;

struct RefusedCall {
    unsigned number;
    unsigned reason;  // errno
};

// From now on these system calls fail in this process. Returns false if that cannot be set up.
bool refuse_calls(const std::vector<RefusedCall>& calls) {
    std::vector<sock_filter> filter{BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, nr))};
    for (const RefusedCall& call : calls) {
        filter.push_back(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, call.number, 0, 1));
        filter.push_back(BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | call.reason));
    }
    filter.push_back(BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW));
    const sock_fprog program{static_cast<unsigned short>(filter.size()), filter.data()};
    return prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 && prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program) == 0;
}

// Runs `work` in a child process and returns its exit code.
int in_own_process(const std::function<int()>& work) {
    const pid_t process = fork();
    if (process == 0) _exit(work());
    int status = 0;
    if (process < 0 || waitpid(process, &status, 0) != process || !WIFEXITED(status)) return -1;
    return WEXITSTATUS(status);
}

TEST(ReplaceFile, FilesAreCreatedWhereThereAreNoHardLinks) {
    enum { kCreated, kNotCreated, kNoFilters };
    const TemporaryFolder folder;
    std::vector<RefusedCall> calls{{__NR_linkat, EPERM}};
#ifdef __NR_link
    calls.push_back({__NR_link, EPERM});
#endif
    for (const char* name : {"without links", "and without renaming to free names"}) {
        const std::filesystem::path path = folder.path() / name;
        const int result = in_own_process([&]() -> int {
            if (!refuse_calls(calls)) return kNoFilters;
            try {
                for (const char* text : {"new", "now"}) create_file(path, std::as_bytes(std::span(text, 3)));
            } catch (const Failure&) {
                return kNotCreated;
            }
            return kCreated;
        });
        if (result == kNoFilters) GTEST_SKIP() << "calls cannot be refused here";
        EXPECT_EQ(result, kCreated) << name;
        EXPECT_EQ(read_file(path), "new") << "what is there stays";
        calls.push_back({__NR_renameat2, EINVAL});
    }
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 2) << "nothing is left over";
}

}  // namespace
}  // namespace throng
